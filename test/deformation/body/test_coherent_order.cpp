// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests whether point orders keep neighbours together.

#include <pcs/deformation/body/coherent_order.h>
#include <pcs/neighborhood/spatial_order.h>
#include <support/point_clouds.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace test_coherent_order {

namespace {

constexpr double pi = 3.14159265358979323846;

using pcs_test::Points;
using pcs_test::Vec3;

bool is_coherent(const Points& points)
{
  return pcs::deformation::is_coherent_order(
      points,
      pcs::neighborhood::spatial_order<CGAL::Sequential_tag>(points));
}

/// Lines along a tube, all in the same direction.
Points scan_lines(int lines, int points_per_line)
{
  Points points;
  for (int i = 0; i < lines; ++i)
    for (int j = 0; j < points_per_line; ++j)
      points.emplace_back(std::cos(2 * pi * i / lines), std::sin(2 * pi * i / lines), 0.05 * j);
  return points;
}

/// Every `stride`-th point, then those after them, and so on.
Points interleaved(const Points& points, std::size_t stride)
{
  Points result;
  for (std::size_t first = 0; first < stride; ++first)
    for (std::size_t i = first; i < points.size(); i += stride)
      result.push_back(points[i]);
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(coherent_order)

BOOST_AUTO_TEST_CASE(rows_and_scan_lines_are_coherent)
{
  const Points grid = pcs_test::plate(99, 79, 0.1), lines = scan_lines(120, 60);
  for (const Points& points : {grid, lines}) {
    BOOST_TEST(is_coherent(points));
    const auto order = pcs::neighborhood::spatial_order<CGAL::Sequential_tag>(points);
    BOOST_TEST(is_coherent(pcs_test::permuted(points, order)));
  }
}

BOOST_AUTO_TEST_CASE(orders_that_jump_are_not)
{
  const Points grid = pcs_test::plate(99, 79, 0.1), lines = scan_lines(120, 60);
  for (const Points& points : {grid, lines}) {
    BOOST_TEST(
        !is_coherent(pcs_test::permuted(points, pcs_test::random_permutation(points.size(), 5))));
    BOOST_TEST(!is_coherent(interleaved(points, 8)));
  }
  BOOST_TEST(!is_coherent(pcs_test::random_points(2000, 1)));
}

BOOST_AUTO_TEST_CASE(a_few_jumps_and_the_ends_of_lines_do_not_matter)
{
  Points points = pcs_test::plate(99, 79, 0.1);
  for (std::size_t i = 0; i + 1 < points.size(); i += 200) // one block in 25
    std::swap(points[i], points[points.size() - 1 - i]);
  BOOST_TEST(is_coherent(points));
  for (std::size_t i = 0; i + 1 < points.size(); i += 24) // one in 3
    std::swap(points[i], points[(i * 7919) % points.size()]);
  BOOST_TEST(!is_coherent(points));
}

BOOST_AUTO_TEST_CASE(tiny_clouds_and_equal_points_have_an_answer)
{
  for (const std::size_t n : {0u, 1u, 7u, 8u, 9u}) {
    Points points(n, Vec3(1, 2, 3));
    BOOST_TEST(is_coherent(points));
    for (std::size_t i = 0; i < n; ++i)
      points[i].x() = double(i);
    BOOST_TEST(is_coherent(points));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_coherent_order
