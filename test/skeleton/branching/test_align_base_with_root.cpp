// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The trunk begins at the root: its axis is cut or extended there.

#include <pcs/skeleton/branching/align_base_with_root.h>
#include <support/axes.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_align_base_with_root {

using namespace pcs::skeleton;

namespace {

constexpr double spacing = 0.01, radius = 0.1, height = 10;
constexpr std::size_t number_of_segments = 50;

/// A vertical trunk, whose points are one for each segment, and three points of the root.
struct Trunk
{
  Scan scan;
  Axis_set set;
  std::vector<Index> root;

  explicit Trunk(const Vec3& root_position)
    : set(pcs_test::set_of(
          {pcs_test::straight_axis({0, 0, 0}, {0, 0, height}, number_of_segments, radius, radius)}))
  {
    scan.spacing = spacing;
    set.axis_of_point.assign(number_of_segments, 0);
    for (Index s = 0; s < number_of_segments; ++s) {
      scan.points.emplace_back(radius, 0, (s + 0.5) * height / double(number_of_segments));
      set.segment_of_point.push_back(s);
    }
    for (int k = 0; k < 3; ++k) {
      root.push_back(static_cast<Index>(scan.size()));
      scan.points.push_back(root_position + Vec3(0, 0, 0.01 * k));
      set.axis_of_point.push_back(none);
      set.segment_of_point.push_back(none);
    }
  }

  double align(bool is_reversed = false)
  {
    return align_base_with_root(scan, root, 0, is_reversed, Base_alignment_options(), set);
  }
  const Axis& axis() const { return set.axes[0].axis; }

  /// Returns whether every point is at the height of its segment, within a tolerance.
  bool are_points_at_their_segments(double tolerance) const
  {
    for (std::size_t i = 0; i < number_of_segments; ++i) {
      const Index s = set.segment_of_point[i];
      if (s + 1 >= axis().size())
        return false;
      const double z = scan.points[i].z();
      const auto [low, high] = std::minmax(axis()[s].point.z(), axis()[s + 1].point.z());
      if (z < low - tolerance || z > high + tolerance)
        return false;
    }
    return true;
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(trunk_at_the_root)

BOOST_AUTO_TEST_CASE(an_axis_above_the_root_is_extended)
{
  Trunk trunk({0.2, 0, -0.73});
  BOOST_TEST(trunk.align() == -0.73, boost::test_tools::tolerance(1e-12));
  BOOST_TEST((trunk.axis().front().point - Vec3(0, 0, -0.73)).norm() < 1e-12);
  BOOST_TEST(!trunk.axis().front().is_measured);
  for (std::size_t k = 0; k + 1 < trunk.axis().size(); ++k)
    BOOST_TEST(trunk.axis()[k + 1].point.z() > trunk.axis()[k].point.z() + 0.01);
  BOOST_TEST(trunk.are_points_at_their_segments(1e-9));
  BOOST_TEST(trunk.align() == 0, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_short_extension_moves_the_first_node)
{
  Trunk trunk({0, 0, -0.03});
  trunk.set.axes[0].axis.front().is_measured = true;
  BOOST_TEST(trunk.align() == -0.03, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(trunk.axis().size() == number_of_segments + 1);
  BOOST_TEST((trunk.axis().front().point - Vec3(0, 0, -0.03)).norm() < 1e-12);
  BOOST_TEST(trunk.axis().front().is_measured);
  BOOST_TEST(trunk.are_points_at_their_segments(1e-9));
}

BOOST_AUTO_TEST_CASE(an_axis_that_begins_below_the_root_is_cut)
{
  Trunk trunk({0, 0.2, 0.73});
  BOOST_TEST(trunk.align() == 0.73, boost::test_tools::tolerance(1e-12));
  BOOST_TEST((trunk.axis().front().point - Vec3(0, 0, 0.73)).norm() < 1e-12);
  BOOST_TEST(trunk.are_points_at_their_segments(0.73));
  BOOST_TEST(trunk.set.segment_of_point[number_of_segments - 1] + 2 == trunk.axis().size());
}

BOOST_AUTO_TEST_CASE(the_root_may_be_at_the_tip)
{
  Trunk longer({0, 0, height + 0.5}), shorter({0, 0, height - 0.5});
  longer.align(true);
  shorter.align(true);
  // the farthest of the three points is 2 cm higher
  BOOST_TEST((longer.axis().back().point - Vec3(0, 0, height + 0.52)).norm() < 1e-12);
  BOOST_TEST((shorter.axis().back().point - Vec3(0, 0, height - 0.48)).norm() < 1e-12);
  BOOST_TEST(longer.are_points_at_their_segments(1e-9));
  BOOST_TEST(shorter.are_points_at_their_segments(0.5));
}

BOOST_AUTO_TEST_CASE(a_leaning_trunk_begins_at_the_height_of_the_root)
{
  // 30 degrees from the vertical; the root is beside the line of the axis
  Trunk trunk({-0.2, 0.2, -0.5});
  for (Axis_node& node : trunk.set.axes[0].axis)
    node.point = node.point.z() * Vec3(0.5, 0, std::sqrt(0.75));
  BOOST_TEST(trunk.align() == -0.5, boost::test_tools::tolerance(1e-12));
  const Vec3& base = trunk.axis().front().point;
  BOOST_TEST(base.z() == -0.5, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(base.x() == -0.5 * std::tan(std::acos(-1.0) / 6), boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(an_axis_whose_base_follows_a_buttress_begins_at_the_height_of_the_root)
{
  // the lowest 0.4 m are nearly horizontal
  Trunk trunk({-0.3, 0, -0.25});
  Axis& axis = trunk.set.axes[0].axis;
  axis[0].point = Vec3(-0.4, 0, 0.3);
  axis[1].point = Vec3(-0.2, 0, 0.35);
  BOOST_TEST(trunk.align() == -0.55, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(axis.front().point.z() == -0.25, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(axis.front().point.x() < -0.4);
  BOOST_TEST(axis.front().point.x() > -0.5);
}

BOOST_AUTO_TEST_CASE(a_lying_trunk_begins_at_its_root)
{
  Trunk trunk({-0.5, 0, 0.1});
  for (Axis_node& node : trunk.set.axes[0].axis)
    node.point = Vec3(node.point.z(), 0, 0);
  BOOST_TEST(trunk.align() == -0.5, boost::test_tools::tolerance(1e-12));
  BOOST_TEST((trunk.axis().front().point - Vec3(-0.5, 0, 0)).norm() < 1e-12);
}

BOOST_AUTO_TEST_CASE(a_root_far_away_changes_nothing)
{
  for (const Vec3& position : {Vec3(1, 0, -0.5), Vec3(0, 0, -4), Vec3(0, 0, 4)}) {
    Trunk trunk(position);
    BOOST_TEST(trunk.align() == 0);
    BOOST_TEST(trunk.axis().size() == number_of_segments + 1);
    BOOST_TEST(trunk.axis().front().point == Vec3(0, 0, 0));
  }
}

BOOST_AUTO_TEST_CASE(a_root_without_points_changes_nothing)
{
  Trunk trunk({0, 0, -0.5});
  trunk.root.clear();
  BOOST_TEST(trunk.align() == 0);
  BOOST_TEST(trunk.axis().size() == number_of_segments + 1);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_align_base_with_root
