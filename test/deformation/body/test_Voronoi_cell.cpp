// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests a Voronoi cell in the plane: lengths of its sides, open sides, and neighbours without a
// common side.

#include <pcs/deformation/body/Voronoi_cell.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace test_Voronoi_cell {

namespace {

using pcs::deformation::Vec2;
using Cell = pcs::deformation::Voronoi_cell;

std::map<std::uint32_t, double> sides(const std::vector<Vec2>& points, double half_side = 10)
{
  Cell cell;
  cell.reset(half_side);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    cell.cut(points[i], i);
  std::map<std::uint32_t, double> result;
  cell.for_each_side([&](std::uint32_t i) { return points[i]; },
                     [&](std::uint32_t i, const Vec2&, double length) { result[i] += length; });
  return result;
}

std::vector<Vec2> ring(int count, double radius)
{
  std::vector<Vec2> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::acos(-1.0) * (k + 0.1) / count;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Voronoi_cell)

BOOST_AUTO_TEST_CASE(regular_polygons_have_equal_sides)
{
  for (const int count : {3, 4, 6, 11}) {
    const auto length = sides(ring(count, 2));
    BOOST_TEST(length.size() == std::size_t(count));
    for (const auto& [index, l] : length)
      BOOST_TEST(std::abs(l - 2 * std::tan(std::acos(-1.0) / count)) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(the_order_of_the_neighbors_does_not_matter)
{
  std::vector<Vec2> points = ring(7, 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] *= 1 + 0.05 * static_cast<double>(i);
  const auto forward = sides(points);
  std::vector<Vec2> reversed(points.rbegin(), points.rend());
  for (const auto& [index, l] : sides(reversed))
    BOOST_TEST(std::abs(l - forward.at(std::uint32_t(points.size() - 1 - index))) < 1e-12);
}

BOOST_AUTO_TEST_CASE(far_neighbors_and_those_at_a_corner_have_no_side)
{
  std::vector<Vec2> points = ring(4, 1);
  const Vec2 diagonal = points[0] + points[1]; // its bisector passes through a corner
  points.push_back(diagonal);
  points.emplace_back(5, 5);
  points.push_back(points[2]); // a duplicate
  const auto length = sides(points);
  BOOST_TEST(length.size() == 4u);
  for (const auto& [index, l] : length)
    BOOST_TEST(std::abs(l - 1) < 1e-8);
}

BOOST_AUTO_TEST_CASE(beside_an_open_side_half_a_side_remains)
{
  // The border of a sheet, without neighbours below.
  const std::vector<Vec2> points{{1, 0}, {0, 1}, {-1, 0}};
  const auto length = sides(points);
  BOOST_TEST(std::abs(length.at(0) - 0.5) < 1e-12);
  BOOST_TEST(std::abs(length.at(1) - 1) < 1e-12);
  BOOST_TEST(std::abs(length.at(2) - 0.5) < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_wire_has_no_sides)
{
  BOOST_TEST(sides({{1, 0}, {-1, 0}, {2, 0}}).empty());
  BOOST_TEST(sides({}).empty());
}

BOOST_AUTO_TEST_CASE(beyond_its_reach_nothing_cuts)
{
  Cell cell;
  cell.reset(1);
  BOOST_TEST(std::abs(cell.reach() - 2 * std::sqrt(2.0)) < 1e-12);
  const double before = cell.radius();
  cell.cut(cell.reach() * 1.001 * Vec2(1, 1).normalized(), 0);
  BOOST_TEST(cell.radius() == before);
  cell.cut(Vec2(1, 1), 1);
  BOOST_TEST(cell.radius() == before); // three corners remain
  for (const Vec2& p : {Vec2(-1, 1), Vec2(1, -1), Vec2(-1, -1)})
    cell.cut(p, 2);
  BOOST_TEST(std::abs(cell.radius() - 1) < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Voronoi_cell
