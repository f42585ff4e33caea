// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The octree order is a permutation that depends on the positions only, for all positions.

#include <pcs/neighborhood/spatial_order.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/test/unit_test.hpp>

namespace test_spatial_order {

namespace {

using pcs_test::Points;
using pcs_test::Vec3;
using Any_tag = CGAL::Parallel_if_available_tag;

bool is_permutation_of_indices(std::vector<std::uint32_t> order, std::size_t n)
{
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != i)
      return false;
  return order.size() == n;
}

/// Checks that exact duplicates are adjacent, in order of their indices.
bool duplicates_are_consecutive(const Points& points, const std::vector<std::uint32_t>& order)
{
  std::vector<std::uint32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return pcs::neighborhood::lexicographically_less(points[a], points[b]);
  });
  std::size_t number_of_places = 0, number_of_runs = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    number_of_places += i == 0 || points[sorted[i]] != points[sorted[i - 1]] ? 1 : 0;
    const bool begins = i == 0 || points[order[i]] != points[order[i - 1]];
    number_of_runs += begins ? 1 : 0;
    if (!begins && order[i] < order[i - 1])
      return false;
  }
  return number_of_places == number_of_runs;
}

/// Checks all documented properties for one cloud.
void check(const Points& points)
{
  const auto order = pcs::neighborhood::spatial_order<Any_tag>(points);
  BOOST_TEST(is_permutation_of_indices(order, points.size()));
  BOOST_TEST(duplicates_are_consecutive(points, order));
  BOOST_TEST((order == pcs::neighborhood::spatial_order<CGAL::Sequential_tag>(points)));
  const auto shuffle = pcs_test::random_permutation(points.size(), 5);
  const Points shuffled = pcs_test::permuted(points, shuffle);
  const auto order_of_shuffled = pcs::neighborhood::spatial_order<Any_tag>(shuffled);
  BOOST_TEST(
      (pcs_test::permuted(shuffled, order_of_shuffled) == pcs_test::permuted(points, order)));
}

} // namespace

BOOST_AUTO_TEST_SUITE(spatial_order)

BOOST_AUTO_TEST_CASE(random_points)
{
  for (const std::size_t n : {0u, 1u, 2u, 16u, 17u, 100u, 30000u})
    check(pcs_test::random_points(n, 1));
}

BOOST_AUTO_TEST_CASE(grids_lines_and_planes)
{
  check(pcs_test::plate(80, 80, 0.1));
  check(pcs_test::box(12, 12, 30, 1. / 3));
  Points line;
  for (int i = 0; i < 5000; ++i)
    line.push_back(i * Vec3(.1, .2, .3));
  check(line);
}

BOOST_AUTO_TEST_CASE(one_far_outlier)
{
  Points points = pcs_test::random_points(5000, 2);
  points.push_back(1e9 * Vec3(1, 1, 1));
  check(points);
}

BOOST_AUTO_TEST_CASE(two_hundred_thousand_copies_of_one_point)
{
  Points points = pcs_test::random_points(1000, 3);
  points.insert(points.begin() + 500, 200000, Vec3(.25, -.5, .125));
  check(points);
  check(Points(40000, Vec3(1, 2, 3)));
}

BOOST_AUTO_TEST_CASE(geometric_sequences)
{
  Points points;
  for (int i = 0; i < 1000; ++i) {
    points.push_back(Vec3(std::ldexp(1.0, -i), 0, 0));
    points.push_back(Vec3(0, std::ldexp(-1.0, -i), std::ldexp(1.0, -i / 2)));
  }
  check(points);
}

BOOST_AUTO_TEST_CASE(neighbouring_floating_point_numbers)
{
  Points points;
  Vec3 p(1, 1, 1);
  for (int i = 0; i < 100; ++i) {
    points.push_back(p);
    p.x() = std::nextafter(p.x(), 2.0);
  }
  check(points);
}

BOOST_AUTO_TEST_CASE(signed_zeros_are_one_place)
{
  check(Points{Vec3(0, 0, 0), Vec3(-0.0, 0, 0), Vec3(1, 0, 0), Vec3(0, -0.0, -0.0)});
}

BOOST_AUTO_TEST_CASE(the_order_is_the_same_for_every_number_of_threads)
{
  const Points points = pcs_test::random_points(100000, 4);
  const auto sequential = pcs::neighborhood::spatial_order<CGAL::Sequential_tag>(points);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      BOOST_TEST((pcs::neighborhood::spatial_order<Any_tag>(points) == sequential));
    });
}

BOOST_AUTO_TEST_CASE(neighbours_in_the_order_are_neighbours_in_space)
{
  const Points points = pcs_test::random_points(20000, 6);
  const auto order = pcs::neighborhood::spatial_order<Any_tag>(points);
  double along_order = 0, along_input = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    along_order += (points[order[i]] - points[order[i - 1]]).norm();
    along_input += (points[i] - points[i - 1]).norm();
  }
  BOOST_TEST(along_order < 0.1 * along_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_spatial_order
