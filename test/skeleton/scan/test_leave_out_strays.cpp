// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0

#include <pcs/skeleton/scan/leave_out_strays.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace test_leave_out_strays {

namespace {

using pcs::skeleton::Vec3;

/// Dense ground beside thin ground on a slope, with stray points below both.
struct Ground
{
  std::vector<Vec3> points;
  std::size_t number_of_dense = 20000, number_of_thin = 700;

  Ground()
  {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> side(0, 10), depth(0.3, 3);
    const auto on_slope = [&](double x0, double below) {
      const double x = x0 + side(random), y = side(random);
      points.emplace_back(x, y, 0.4 * x - below);
    };
    for (std::size_t i = 0; i < number_of_dense; ++i)
      on_slope(0, 0);
    for (std::size_t i = 0; i < number_of_thin; ++i)
      on_slope(10, 0);
    for (int i = 0; i < 1000; ++i)
      on_slope(i % 2 == 0 ? 0 : 10, depth(random));
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(leave_out_strays)

BOOST_AUTO_TEST_CASE(thin_ground_remains_and_stray_points_do_not)
{
  const Ground ground;
  pcs::skeleton::Scan scan;
  pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(ground.points, Vec3::UnitZ(), scan);
  const std::vector<std::uint8_t> is_used =
      pcs::skeleton::leave_out_strays(scan, std::vector<std::uint8_t>(scan.size(), 1));
  std::size_t dense = 0, thin = 0, stray = 0;
  for (std::size_t i = 0; i < ground.points.size(); ++i) {
    const bool is_kept = is_used[scan.point_of_input[i]] != 0;
    if (i < ground.number_of_dense)
      dense += is_kept;
    else if (i < ground.number_of_dense + ground.number_of_thin)
      thin += is_kept;
    else
      stray += is_kept;
  }
  BOOST_TEST(dense == ground.number_of_dense);
  BOOST_TEST(double(thin) > 0.9 * double(ground.number_of_thin));
  BOOST_TEST(stray < 50u);
}

BOOST_AUTO_TEST_CASE(points_left_out_before_remain_left_out)
{
  const Ground ground;
  pcs::skeleton::Scan scan;
  pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(ground.points, Vec3::UnitZ(), scan);
  const std::vector<std::uint8_t> is_used =
      pcs::skeleton::leave_out_strays(scan, std::vector<std::uint8_t>(scan.size(), 0));
  for (const std::uint8_t flag : is_used)
    BOOST_TEST_REQUIRE(flag == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_leave_out_strays
