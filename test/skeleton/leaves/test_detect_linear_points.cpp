// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rows of points are lines; points in a volume are not.

#include <pcs/skeleton/leaves/detect_linear_points.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace test_detect_linear_points {

using namespace pcs::skeleton;

namespace {

/// A scan of spacing 1: a row of points, and points in a cube of density 1 about `center`.
struct Row_and_cube
{
  static constexpr std::size_t row_size = 41;
  Scan scan;
  std::vector<std::uint8_t> is_in_row;

  explicit Row_and_cube(const Vec3& center)
  {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto draw = [&](double size) {
      const double x = size * uniform(random), y = size * uniform(random);
      return Vec3(x, y, size * uniform(random));
    };
    const Vec3 along = Vec3(1, 2, 2) / 3;
    for (std::size_t k = 0; k < row_size; ++k)
      scan.points.emplace_back((double(k) - 0.5 * double(row_size - 1)) * along + draw(0.2));
    constexpr double half = 9;
    for (std::size_t k = 0; k < std::size_t(8 * half * half * half); ++k)
      scan.points.emplace_back(center + draw(half));
    is_in_row.assign(scan.size(), 0);
    std::fill(is_in_row.begin(), is_in_row.begin() + row_size, std::uint8_t(1));
    scan.spacing = 1;
    scan.search = std::make_unique<pcs::neighborhood::Nearest_neighbors>(scan.points);
  }

  /// Numbers of marked points in the row, and of others.
  std::vector<std::size_t> marked(const std::vector<std::uint8_t>& is_used,
                                  const std::vector<std::uint8_t>& is_sure) const
  {
    const auto is_marked =
        points_on_lines<CGAL::Sequential_tag>(scan, is_used, is_sure, Linear_point_options());
    std::vector<std::size_t> result{0, 0};
    for (std::size_t i = 0; i < scan.size(); ++i)
      result[is_in_row[i] ? 0 : 1] += is_marked[i];
    return result;
  }
  std::vector<std::uint8_t> all(std::uint8_t value) const
  {
    return std::vector<std::uint8_t>(scan.size(), value);
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(rows_of_points)

BOOST_AUTO_TEST_CASE(a_row_in_the_open_is_a_line_and_a_cube_of_points_is_none)
{
  const Row_and_cube points(Vec3(60, 0, 0));
  const std::vector<std::size_t> marked = points.marked(points.all(1), points.all(0));
  BOOST_TEST(marked[0] == Row_and_cube::row_size);
  BOOST_TEST(marked[1] < points.scan.size() / 100);
}

BOOST_AUTO_TEST_CASE(a_row_among_as_many_points_is_no_line_unless_they_are_unused)
{
  const Row_and_cube points(Vec3::Zero());
  BOOST_TEST(points.marked(points.all(1), points.all(0))[0] < 10u); // the ends lie outside
  const std::vector<std::size_t> alone = points.marked(points.is_in_row, points.all(0));
  BOOST_TEST(alone[0] == Row_and_cube::row_size);
  BOOST_TEST(alone[1] == 0u);
}

BOOST_AUTO_TEST_CASE(sure_points_are_not_tested_but_can_be_on_lines_of_others)
{
  const Row_and_cube points(Vec3(60, 0, 0));
  BOOST_TEST(points.marked(points.is_in_row, points.is_in_row)[0] == 0u);
  std::vector<std::uint8_t> is_sure = points.is_in_row;
  is_sure[Row_and_cube::row_size / 2] = 0;
  const std::size_t number = points.marked(points.is_in_row, is_sure)[0];
  BOOST_TEST(number > 15u); // within the reach of 10.4 spacings on both sides
  BOOST_TEST(number <= 21u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_detect_linear_points
