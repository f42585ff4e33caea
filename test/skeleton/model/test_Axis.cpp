// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Resampling of an axis, the nearest position on it, and the points near it.

#include <pcs/internal/Random_stream.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/model/Axis.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace test_Axis {

using pcs::skeleton::Vec3;

namespace {

pcs::skeleton::Axis axis_of(const std::vector<Vec3>& points)
{
  pcs::skeleton::Axis axis(points.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    axis[k].point = points[k];
  return axis;
}

/// Number of segments that a search from segment `guess` visits, with the first.
std::size_t number_of_visits(const pcs::skeleton::Axis& axis, std::size_t guess, const Vec3& p)
{
  std::size_t count = 0;
  const auto segment_at = [&](std::size_t s) {
    ++count;
    return pcs::skeleton::Axis_segment(axis[s], axis[s + 1]);
  };
  pcs::skeleton::internal::Place_search search(axis.size() - 2, segment_at, p);
  search.offer(guess);
  search.walk<true>(guess);
  search.walk<false>(guess);
  return count;
}

Vec3 random_vector(pcs::internal::Random_stream& random, double most)
{
  const double x = random.uniform(-most, most), y = random.uniform(-most, most);
  return Vec3(x, y, random.uniform(-most, most));
}

/// A random walk, which comes near itself.
pcs::skeleton::Axis random_axis(pcs::internal::Random_stream& random, std::size_t count)
{
  std::vector<Vec3> nodes{Vec3::Zero()};
  while (nodes.size() < count)
    nodes.push_back(nodes.back() + random_vector(random, 1));
  return axis_of(nodes);
}

} // namespace

BOOST_AUTO_TEST_SUITE(Axis)

BOOST_AUTO_TEST_CASE(resampling_keeps_ends_and_length)
{
  pcs::skeleton::Axis axis(3);
  axis[1].point = Vec3(1, 0, 0);
  axis[2].point = Vec3(1, 2, 0);
  for (auto& node : axis)
    node.radius = 0.1;
  const auto result = pcs::skeleton::resample(axis, {1, 0.01, 1});
  BOOST_CHECK_EQUAL(result.size(), 31u);
  BOOST_CHECK(result.front().point == axis.front().point);
  BOOST_CHECK(result.back().point == axis.back().point);
  BOOST_CHECK_CLOSE(pcs::skeleton::length_of(result), 3.0, 1.0);
}

BOOST_AUTO_TEST_CASE(resampling_interpolates_radii)
{
  pcs::skeleton::Axis axis(2);
  axis[1].point = Vec3(0, 0, 1);
  axis[0].radius = 0.1;
  axis[1].radius = 0.3;
  const auto result = pcs::skeleton::resample(axis, {1, 0.01, 0.1});
  BOOST_REQUIRE_EQUAL(result.size(), 11u);
  for (const auto& node : result)
    BOOST_CHECK_CLOSE(node.radius, 0.1 + 0.2 * node.point.z(), 1e-9);
}

BOOST_AUTO_TEST_CASE(resampling_divides_every_segment_by_its_radii)
{
  auto axis = axis_of({Vec3(0, 0, 0), Vec3(0, 0, 0.96), Vec3(0, 0, 1.04), Vec3(0, 0, 2)});
  axis.push_back(axis.back());
  axis.back().point.z() = 4;
  for (auto& node : axis)
    node.radius = 0.1;
  axis.back().radius = 0.3; // the mean of the last segment is 0.2
  const auto result = pcs::skeleton::resample(axis, {1, 0.01, 1});
  BOOST_TEST_REQUIRE(result.size() == 31u);
  for (std::size_t k = 0; k < result.size(); ++k)
    BOOST_TEST(result[k].point.z() == (k <= 20 ? 0.1 * double(k) : 0.2 * double(k) - 2),
               boost::test_tools::tolerance(1e-12));
  BOOST_TEST(pcs::skeleton::resample(axis, {1, 10, 10}).size() == 2u);
}

BOOST_AUTO_TEST_CASE(a_node_between_two_has_the_other_values_of_the_nearer_one)
{
  auto axis = axis_of({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0)});
  for (std::size_t k = 0; k < axis.size(); ++k)
    axis[k].radius = axis[k].radius_error = double(k + 1);
  for (const double at : {0.0, 0.25, 0.75, 1.25, 1.75, 2.0}) {
    const auto node = pcs::skeleton::node_at(axis, at);
    BOOST_TEST(node.point.x() == (at < 1 ? at : 2 * at - 1));
    BOOST_TEST(node.radius == at + 1);
    BOOST_TEST(node.radius_error == std::round(at) + 1);
  }
}

BOOST_AUTO_TEST_CASE(a_place_beyond_an_end_says_so)
{
  pcs::skeleton::Axis axis(2);
  axis[1].point = Vec3(0, 0, 1);
  const auto before = pcs::skeleton::nearest_place(axis, 0, Vec3(0, 0, -1));
  BOOST_CHECK_LT(before.share, 0);
  BOOST_CHECK_CLOSE(before.distance, 1.0, 1e-9);
  BOOST_CHECK_CLOSE(pcs::skeleton::nearest_place(axis, 0, Vec3(3, 0, 0.25)).share, 0.25, 1e-9);
  axis[0].radius = 2;
  axis[1].radius = 1;
  const auto after = pcs::skeleton::nearest_place(axis, 0, Vec3(0, 0, 3));
  BOOST_CHECK_GT(after.share, 1);
  BOOST_CHECK(point_at(axis, before) == axis[0].point && point_at(axis, after) == axis[1].point);
  BOOST_CHECK(radius_at(axis, before) == 2 && radius_at(axis, after) == 1);
  BOOST_CHECK(radius_at(axis, {0, 0.25, 0}) == 1.75);
}

BOOST_AUTO_TEST_CASE(a_bent_axis_has_the_same_place_from_every_guess)
{
  std::vector<Vec3> nodes;
  for (int k = 0; k <= 20; ++k)
    nodes.emplace_back(10 * std::cos(0.1 * k), 10 * std::sin(0.1 * k), 0);
  const auto axis = axis_of(nodes);
  const auto segments = pcs::skeleton::segments_of(axis);
  for (const double radius : {9.5, 10.5})
    for (double angle = -0.2; angle < 2.3; angle += 0.037) {
      const Vec3 p(radius * std::cos(angle), radius * std::sin(angle), 0.3);
      const auto expected = pcs::skeleton::nearest_place(axis, p);
      for (std::size_t guess = 0; guess <= 20; ++guess)
        for (const auto& place : {pcs::skeleton::nearest_place(axis, guess, p),
                                  pcs::skeleton::nearest_place(segments, guess, p)}) {
          // two segments have the same distance from a point outside of their common node
          BOOST_TEST(std::abs(place.distance - expected.distance) < 1e-12);
          BOOST_TEST((point_at(axis, place) - point_at(axis, expected)).norm() < 1e-12);
          BOOST_TEST((place.share < 0) == (angle < 0));
          BOOST_TEST((place.share > 1) == (angle > 2));
        }
      BOOST_TEST((expected.share < 0) == (angle < 0));
      BOOST_TEST((expected.share > 1) == (angle > 2));
    }
}

// A zigzag: its middle segment is farther than both others.
BOOST_AUTO_TEST_CASE(the_search_passes_a_farther_segment_that_does_not_lead_away)
{
  std::vector<Vec3> nodes = {Vec3(-10, 0, 0),
                             Vec3(-5, 0, 0),
                             Vec3(0, 0, 0),
                             Vec3(10, 0, 0),
                             Vec3(0, 4, 0),
                             Vec3(3, 0.5, 0)};
  const Vec3 p(2, 1, 0);
  for (const std::size_t guess : {0u, 1u, 2u})
    BOOST_TEST(pcs::skeleton::nearest_place(axis_of(nodes), guess, p).segment == 4u);
  std::reverse(nodes.begin(), nodes.end());
  for (const std::size_t guess : {4u, 3u, 2u})
    BOOST_TEST(pcs::skeleton::nearest_place(axis_of(nodes), guess, p).segment == 0u);
}

BOOST_AUTO_TEST_CASE(the_search_ends_where_the_axis_leads_away)
{
  std::vector<Vec3> nodes;
  for (int k = 0; k <= 20; ++k)
    nodes.emplace_back(0, 0, k);
  const auto axis = axis_of(nodes);
  // the segment of the point, and one in each direction
  BOOST_TEST(number_of_visits(axis, 10, Vec3(1, 0, 10.5)) == 3u);
  // five on the way to the point, one beyond it, and one in the other direction
  BOOST_TEST(number_of_visits(axis, 5, Vec3(1, 0, 10.5)) == 8u);
  BOOST_TEST(number_of_visits(axis, 15, Vec3(1, 0, 10.5)) == 8u);
  BOOST_TEST(number_of_visits(axis, 0, Vec3(1, 0, 0.5)) == 2u);
  BOOST_TEST(number_of_visits(axis, 19, Vec3(1, 0, 19.5)) == 2u);
  // about the center of an arc, no segment is nearer, and none leads away
  for (int k = 0; k <= 20; ++k)
    nodes[std::size_t(k)] = Vec3(std::cos(0.1 * k), std::sin(0.1 * k), 1e-3 * std::abs(k - 10.5));
  BOOST_TEST(number_of_visits(axis_of(nodes), 10, Vec3(0, 0, 0)) == 5u);
}

BOOST_AUTO_TEST_CASE(a_projector_finds_the_nearest_of_all_segments)
{
  pcs::internal::Random_stream random(1, 1);
  for (const std::size_t count : {2u, 9u, 10u, 60u}) {
    auto axis = random_axis(random, count);
    axis[count / 2].point = axis[count / 2 - 1].point; // a segment without length
    const pcs::skeleton::Axis_projector project(axis);
    for (int k = 0; k < 300; ++k) {
      const Vec3 p = k % 10 == 0 ? axis[std::size_t(k) % count].point : random_vector(random, 5);
      const auto expected = pcs::skeleton::nearest_place(axis, p);
      for (const std::size_t guess : {std::size_t(0), count / 2, count}) {
        const auto place = project(guess, p);
        BOOST_TEST(place.segment == expected.segment);
        BOOST_TEST(place.share == expected.share);
        BOOST_TEST(place.distance == expected.distance);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(points_near_an_axis_are_near_one_of_its_nodes)
{
  pcs::internal::Random_stream random(2, 1);
  const auto axis = random_axis(random, 30);
  pcs::skeleton::Scan scan;
  for (int k = 0; k < 3000; ++k)
    scan.points.push_back(random_vector(random, 5));
  scan.search = std::make_unique<pcs::neighborhood::Nearest_neighbors>(scan.points);
  const auto reach = [](std::size_t k) { return 0.25 * double(k % 7); };
  std::vector<pcs::skeleton::Index> expected;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    for (std::size_t k = 0; k < axis.size(); ++k)
      if (i == 5 || (scan.points[i] - axis[k].point).norm() < reach(k)) {
        expected.push_back(pcs::skeleton::Index(i));
        break;
      }
  BOOST_TEST(expected.size() > 100u);
  BOOST_TEST(expected.size() < 2900u);
  BOOST_TEST(pcs::skeleton::points_near(scan, axis, reach, {5}) == expected,
             boost::test_tools::per_element());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Axis
