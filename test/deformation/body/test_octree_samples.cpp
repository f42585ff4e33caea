// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Samples have the requested number, are distinct, and follow the density of the points.

#include <pcs/deformation/body/octree_samples.h>
#include <support/networks.h>

#include <boost/test/unit_test.hpp>

#include <set>

namespace test_octree_samples {

namespace {

using pcs_test::Points;
using pcs_test::Vec3;

/// Checks the number of samples and their ascending order.
std::vector<std::uint32_t>
checked_samples(const Points& ordered, std::size_t count, bool is_even = true)
{
  auto samples = pcs::deformation::octree_samples(ordered, count, is_even);
  BOOST_TEST(samples.size() == std::min(count, ordered.size()));
  BOOST_TEST((std::adjacent_find(samples.begin(), samples.end(), std::greater_equal<>()) ==
              samples.end()));
  BOOST_TEST((samples.empty() || samples.back() < ordered.size()));
  return samples;
}

} // namespace

BOOST_AUTO_TEST_SUITE(octree_samples)

BOOST_AUTO_TEST_CASE(there_are_exactly_as_many_as_asked_for_and_all_differ)
{
  const Points points = pcs_test::in_spatial_order(pcs_test::random_points(1000, 1));
  for (std::size_t count = 1; count < 300; ++count)
    for (const bool is_even : {false, true})
      checked_samples(points, count, is_even);
  for (const std::size_t count : {500u, 998u, 999u, 1000u, 1001u, 5000u})
    checked_samples(points, count);
}

BOOST_AUTO_TEST_CASE(any_cloud_can_be_sampled)
{
  Points line, sequence = pcs_test::random_points(300, 2);
  for (int i = 0; i < 700; ++i)
    line.push_back(i * Vec3(.1, .2, .3));
  for (int i = 0; i < 1000; ++i)
    sequence.push_back(Vec3(std::ldexp(1.0, -i), 0, 0));
  sequence.push_back(Vec3(1e9, 0, 0));
  for (const Points& points : {line, sequence, pcs_test::plate(25, 25, .1), Points{Vec3(1, 2, 3)}})
    for (const std::size_t count : {1u, 2u, 3u, 10u, 99u, 400u})
      for (const bool is_even : {false, true})
        checked_samples(pcs_test::in_spatial_order(points), count, is_even);
}

BOOST_AUTO_TEST_CASE(as_many_as_points_gives_all_points)
{
  const auto samples =
      checked_samples(pcs_test::in_spatial_order(pcs_test::random_points(50, 3)), 50);
  for (std::size_t i = 0; i < 50; ++i)
    BOOST_TEST(samples[i] == i);
}

BOOST_AUTO_TEST_CASE(dense_parts_get_more_samples)
{
  // The left half has nine times as many points as the right one.
  Points points;
  for (const Vec3& p : pcs_test::random_points(10000, 4))
    points.push_back(p.x() < 0 || points.size() % 9 == 0 ? p : Vec3(-p.x(), p.y(), p.z()));
  const Points ordered = pcs_test::in_spatial_order(points);
  std::size_t left = 0, left_points = 0;
  for (const auto s : checked_samples(ordered, 500))
    left += ordered[s].x() < 0 ? 1 : 0;
  for (const Vec3& p : ordered)
    left_points += p.x() < 0 ? 1 : 0;
  const double share = double(left_points) / double(points.size());
  BOOST_TEST(share > 0.85);
  BOOST_TEST(double(left) / 500 == share, boost::test_tools::tolerance(0.1));
}

BOOST_AUTO_TEST_CASE(every_point_has_a_sample_nearby)
{
  const Points ordered = pcs_test::in_spatial_order(pcs_test::plate(60, 60, 1));
  const auto samples = checked_samples(ordered, 225); // about one per 4 x 4 cells
  double largest = 0;
  for (const Vec3& p : ordered) {
    double nearest = 1e9;
    for (const auto s : samples)
      nearest = std::min(nearest, (ordered[s] - p).norm());
    largest = std::max(largest, nearest);
  }
  BOOST_TEST(largest < 8); // twice the mean distance of the samples
}

BOOST_AUTO_TEST_CASE(samples_of_an_even_cloud_are_evenly_spaced)
{
  // If octants were split up to the last leaf, the spacing would vary by 0.34, 0.24 and 0.28.
  const Points ordered = pcs_test::in_spatial_order(pcs_test::plate(75, 76, 1));
  for (const std::size_t count : {600u, 700u, 2000u}) {
    const auto samples = checked_samples(ordered, count);
    double sum = 0, sum_of_squares = 0;
    for (const auto s : samples) {
      double nearest = 1e9;
      for (const auto t : samples)
        if (s != t)
          nearest = std::min(nearest, (ordered[s] - ordered[t]).norm());
      sum += nearest / double(count);
      sum_of_squares += nearest * nearest / double(count);
    }
    const double variation = std::sqrt(sum_of_squares - sum * sum) / sum;
    BOOST_TEST_MESSAGE(count << " samples: variation of the spacing " << variation);
    BOOST_TEST(variation < 0.2, count << " samples: " << variation);
  }
}

BOOST_AUTO_TEST_CASE(the_positions_of_the_samples_do_not_depend_on_the_order_of_the_points)
{
  for (const Points& points : {pcs_test::random_points(2000, 5), pcs_test::box(8, 8, 24, 1. / 3)}) {
    const Points a = pcs_test::in_spatial_order(points);
    const Points b = pcs_test::in_spatial_order(
        pcs_test::permuted(points, pcs_test::random_permutation(points.size(), 6)));
    BOOST_TEST((pcs_test::permuted(a, checked_samples(a, 150)) ==
                pcs_test::permuted(b, checked_samples(b, 150))));
  }
}

BOOST_AUTO_TEST_CASE(a_shifted_grid_has_the_shifted_samples)
{
  const Vec3 shift(5e6, -4.4e6, 123.456);
  const Points a = pcs_test::in_spatial_order(pcs_test::box(9, 9, 31, 1. / 9));
  Points shifted;
  for (const Vec3& p : a)
    shifted.push_back((p + shift) - shift); // with the rounding errors of a shift
  const Points b = pcs_test::in_spatial_order(shifted);
  for (const std::size_t count : {50u, 200u, 700u})
    BOOST_TEST(pcs_test::largest_distance(pcs_test::permuted(a, checked_samples(a, count)),
                                          pcs_test::permuted(b, checked_samples(b, count))) < 1e-8);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_octree_samples
