// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Acceptance of axes with two points.

#include <pcs/skeleton/axes/drop_two_point_axes.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <vector>

namespace test_drop_two_point_axes {

using namespace pcs::skeleton;

namespace {

/// Axes with the given numbers of points, each the parent of the next.
Axis_set set_of(const std::vector<std::size_t>& counts)
{
  Axis_set set;
  for (std::size_t a = 0; a < counts.size(); ++a) {
    for (std::size_t k = 0; k < counts[a]; ++k) {
      set.axis_of_point.push_back(static_cast<Index>(a));
      set.segment_of_point.push_back(0);
    }
    set.axes.push_back({Axis(2), a == 0 ? none : static_cast<Index>(a - 1), counts[a], 1});
  }
  return set;
}

} // namespace

BOOST_AUTO_TEST_SUITE(two_point_axes)

BOOST_AUTO_TEST_CASE(pairs_among_triples_stay)
{
  Axis_set set = set_of({9, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2});
  BOOST_TEST(drop_two_point_axes(Two_point_axis_options(), set) == 0u);
  BOOST_TEST(set.axes.size() == 13u);
}

BOOST_AUTO_TEST_CASE(pairs_without_triples_go_and_leave_their_children)
{
  Axis_set set = set_of({9, 2, 8, 2, 2, 3});
  BOOST_TEST(drop_two_point_axes(Two_point_axis_options(), set) == 3u);
  BOOST_TEST_REQUIRE(set.axes.size() == 3u);
  BOOST_TEST(set.axes[0].parent == none);
  BOOST_TEST(set.axes[1].parent == 0u);
  BOOST_TEST(set.axes[1].number_of_points == 8u);
  BOOST_TEST(set.axes[2].parent == 1u);
  BOOST_TEST(set.axis_of_point[8] == 0u);
  BOOST_TEST(set.axis_of_point[9] == none);
  BOOST_TEST(set.axis_of_point[11] == 1u);
  BOOST_TEST(set.axis_of_point.back() == 2u);
}

BOOST_AUTO_TEST_CASE(pairs_go_if_a_few_axes_are_all_there_is)
{
  Axis_set set = set_of({9, 2, 3, 3});
  BOOST_TEST(drop_two_point_axes(Two_point_axis_options(), set) == 1u);
  BOOST_TEST(set.axes.size() == 3u);
}

BOOST_AUTO_TEST_CASE(a_few_pairs_among_many_axes_go)
{
  std::vector<std::size_t> counts(60, 20);
  counts.insert(counts.end(), 6, 3);
  counts.push_back(2);
  Axis_set set = set_of(counts);
  BOOST_TEST(drop_two_point_axes(Two_point_axis_options(), set) == 1u);
  BOOST_TEST(set.axes.size() == 66u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_drop_two_point_axes
