// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scans that contain nothing but a sheet are told from small trees on wide ground.

#include <pcs/skeleton/clutter/is_single_sheet.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace test_is_single_sheet {

using namespace pcs::skeleton;

namespace {

/// A rough square sheet of 20 x 20, with `trunk` points on a line of the height 3 in its middle,
/// and `strays` points up to this height anywhere above it.
bool is_sheet(std::size_t sheet, std::size_t trunk, std::size_t strays)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-10, 10), share(0, 1);
  Scan scan;
  for (std::size_t i = 0; i < sheet; ++i)
    scan.points.emplace_back(place(random), place(random), 0.01 * share(random));
  for (std::size_t i = 0; i < trunk; ++i)
    scan.points.emplace_back(0.02 * share(random), 0.02 * share(random), 3 * share(random));
  for (std::size_t i = 0; i < strays; ++i)
    scan.points.emplace_back(place(random), place(random), 3 * share(random));
  scan.spacing = 0.02;
  return is_single_sheet(scan, std::vector<std::uint8_t>(scan.points.size(), 1), Sheet_options());
}

} // namespace

BOOST_AUTO_TEST_SUITE(single_sheets)

BOOST_AUTO_TEST_CASE(a_tree_may_have_a_fraction_of_the_points)
{
  BOOST_TEST(is_sheet(20000, 0, 0));
  BOOST_TEST(!is_sheet(20000, 200, 0));
  BOOST_TEST(!is_sheet(300000, 200, 0));
  BOOST_TEST(!is_sheet(300000, 200, 20));
}

BOOST_AUTO_TEST_CASE(stray_points_are_no_tree)
{
  BOOST_TEST(is_sheet(20000, 0, 10));
  BOOST_TEST(is_sheet(300000, 0, 200));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_is_single_sheet
