// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the k nearest points with a brute-force search.

#include <pcs/neighborhood/Nearest_neighbors.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace test_Nearest_neighbors {

namespace {

using Tree = pcs::neighborhood::Nearest_neighbors;
using pcs_test::Points;
using pcs_test::Vec3;

std::vector<double> nearest_squared_distances(const Points& points, const Vec3& query)
{
  std::vector<double> distances;
  for (const Vec3& p : points)
    distances.push_back((p - query).squaredNorm());
  std::sort(distances.begin(), distances.end());
  return distances;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Nearest_neighbors)

BOOST_AUTO_TEST_CASE(they_are_the_nearest_and_come_in_order)
{
  const Points points = pcs_test::random_points(500, 1);
  const Tree nearest(points);
  std::vector<Tree::Neighbor> found;
  std::mt19937 random(2);
  for (int repetition = 0; repetition < 100; ++repetition) {
    const Vec3 query = 1.5 * pcs_test::random_vector(random);
    const auto expected = nearest_squared_distances(points, query);
    for (const std::size_t k : {1u, 2u, 7u, 64u}) {
      nearest(query, k, found);
      BOOST_REQUIRE(found.size() == k);
      for (std::size_t b = 0; b < k; ++b) {
        BOOST_TEST(found[b].squared_distance == expected[b], boost::test_tools::tolerance(1e-13));
        BOOST_TEST(found[b].squared_distance == (points[found[b].index] - query).squaredNorm(),
                   boost::test_tools::tolerance(1e-13));
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(fewer_points_than_asked_for_are_all_returned)
{
  for (const std::size_t n : {0u, 1u, 2u, 5u}) {
    const Points points = pcs_test::random_points(n, 3);
    const Tree nearest(points);
    std::vector<Tree::Neighbor> found(3);
    nearest(Vec3(0, 0, 0), 10, found);
    BOOST_TEST(found.size() == n);
  }
}

BOOST_AUTO_TEST_CASE(equal_distances_are_ordered_by_coordinates)
{
  const Points points{Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(0, 0, -1)};
  const Tree nearest(points);
  std::vector<Tree::Neighbor> found;
  nearest(Vec3(0, 0, 0), 5, found);
  BOOST_REQUIRE(found.size() == 5u);
  const std::size_t expected[] = {3, 4, 2, 0, 1};
  for (std::size_t b = 0; b < 5; ++b)
    BOOST_TEST(found[b].index == expected[b]);
}

BOOST_AUTO_TEST_CASE(of_the_nearest_points_the_lexicographically_smallest_is_taken)
{
  const auto any = [](std::uint32_t) { return true; };
  for (const double r : {1e-3, 0.25, 1.0, 64.0}) {
    Points points;
    for (int k = 0; k < 20; ++k) // the nearest ones are in different leaves of the tree
      for (const Vec3& p : {Vec3(0, r, 0), Vec3(r, 0, 0), Vec3(0, 0, r), Vec3(-r, 0, 0)})
        points.push_back((1 + 0.25 * k) * p);
    for (std::size_t shift = 0; shift < points.size(); ++shift) {
      std::rotate(points.begin(), points.begin() + 1, points.end());
      const Tree nearest(points);
      const Tree::Neighbor found = nearest.nearest_if(Vec3(0, 0, 0), 10 * r, any);
      BOOST_TEST((points[found.index] == Vec3(-r, 0, 0)));
      BOOST_TEST(found.squared_distance == r * r);
    }
  }
}

BOOST_AUTO_TEST_CASE(points_within_a_radius_are_appended_in_the_order_of_their_indices)
{
  const Points points = pcs_test::random_points(500, 6);
  const Tree nearest(points);
  std::vector<std::uint32_t> found{7, 3};
  nearest.within(points[0], 0.5, found);
  BOOST_REQUIRE(found.size() > 20u);
  BOOST_TEST(found[0] == 7u);
  BOOST_TEST(found[1] == 3u);
  BOOST_TEST(std::is_sorted(found.begin() + 2, found.end()));
}

BOOST_AUTO_TEST_CASE(nothing_is_nearer_than_the_radius)
{
  const Points points = pcs_test::random_points(100, 4);
  const Tree nearest(points);
  const auto any = [](std::uint32_t) { return true; };
  const auto none = [](std::uint32_t) { return false; };
  const double infinity = std::numeric_limits<double>::infinity();
  BOOST_TEST(nearest.nearest_if(Vec3(9, 0, 0), 2, any).squared_distance == infinity);
  BOOST_TEST(nearest.nearest_if(points[3], 2, none).squared_distance == infinity);
  BOOST_TEST(nearest.nearest_if(points[3], 2, any).index == 3u);
}

// Cuts do not separate many copies of one point. Points at 1e-12 beside points at 1e3 need many
// cuts.
BOOST_AUTO_TEST_CASE(copies_and_unlike_scales_are_found)
{
  Points points(1000, Vec3(1, 2, 3));
  for (int k = -40; k < 11; ++k)
    points.push_back(Vec3(std::ldexp(1.0, k), 0, 0));
  const Tree nearest(points);
  std::vector<Tree::Neighbor> found;
  for (std::size_t i = 1000; i < points.size(); ++i) {
    nearest(points[i], 2, found);
    BOOST_TEST(found[0].index == i);
    BOOST_TEST(found[1].squared_distance > 0);
  }
  std::vector<std::uint32_t> inside;
  nearest.within(Vec3(1, 2, 3), 0.5, inside);
  BOOST_TEST(inside.size() == 1000u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Nearest_neighbors
