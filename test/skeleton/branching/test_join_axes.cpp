// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Parents of axes, the continuation at a fork, and corrections in a second pass.

#include <pcs/skeleton/branching/group_branches.h>
#include <pcs/skeleton/branching/join_axes.h>
#include <pcs/skeleton/branching/regroup_axes.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <support/axes.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_join_axes {

using namespace pcs::skeleton;

namespace {

using pcs_test::set_of;
constexpr double spacing = 0.01;

Axis straight(const Vec3& from, const Vec3& to, double radius, double tip_radius)
{
  return pcs_test::straight_axis(from, to, 20, radius, tip_radius);
}

std::vector<Joint> join(const Axis_set& set)
{
  return Axis_joiner(set, spacing, Joint_options()).run<CGAL::Sequential_tag>(0);
}

Branch_tree tree_of(const Axis_set& set)
{
  return branch_tree(set, join(set), 0, spacing);
}

/// A stem, and a stick beside it that has no other possible parent.
const Axis stem = straight({0, 0, 0}, {0, 0, 2}, 0.05, 0.04);

} // namespace

BOOST_AUTO_TEST_SUITE(joined_axes)

BOOST_AUTO_TEST_CASE(a_branch_sits_where_it_points_back_to)
{
  const Axis_set set = set_of({stem, straight({0.1, 0, 1.1}, {0.6, 0, 1.6}, 0.01, 0.004)});
  const std::vector<Joint> joints = join(set);
  BOOST_TEST(joints[0].parent == none);
  BOOST_TEST(joints[1].parent == 0u);
  BOOST_TEST(!joints[1].is_reversed);
  BOOST_TEST(std::abs(point_at(stem, joints[1].place).z() - 1) < 0.02);
}

BOOST_AUTO_TEST_CASE(the_thick_end_of_a_branch_is_its_base)
{
  // A bridge between two stems, traced from its tip.
  const Axis other = straight({0.6, 0, 0}, {0.6, 0, 2}, 0.05, 0.04);
  const Axis_set set =
      set_of({stem, other, straight({0.53, 0, 1.4}, {0.07, 0, 1.3}, 0.004, 0.012)});
  const std::vector<Joint> joints = join(set);
  BOOST_TEST(joints[2].parent == 0u);
  BOOST_TEST(joints[2].is_reversed);
}

BOOST_AUTO_TEST_CASE(of_two_branches_as_near_the_thicker_one_is_the_parent)
{
  for (const bool is_left_thick : {true, false}) {
    const double left = is_left_thick ? 0.012 : 0.003, right = is_left_thick ? 0.003 : 0.012;
    const Axis_set set = set_of({straight({0, 0, -1}, {0, 0, 0}, 0.05, 0.04),
                                 straight({0, 0, 0}, {-0.02, 0.01, 0.5}, left, left),
                                 straight({0, 0, 0}, {-0.02, -0.01, 0.5}, right, right),
                                 straight({0.03, 0, 0.4}, {0.3, 0, 0.55}, 0.004, 0.002)});
    BOOST_TEST(join(set)[3].parent == (is_left_thick ? 1u : 2u));
  }
}

BOOST_AUTO_TEST_CASE(a_branch_leaves_its_parent_towards_the_tip)
{
  // Two branches cross in front of the base of a third one. It leaves one of them at 40 degrees,
  // and would need a reversal from the other.
  const Axis_set set = set_of({straight({0, 0, -0.5}, {0, 0, 0}, 0.05, 0.04),
                               straight({0, 0, 0}, {0.5, 0.006, 0.5}, 0.01, 0.01),
                               straight({0.5, -0.006, 0}, {0, -0.006, 0.5}, 0.01, 0.01),
                               straight({0.28, 0, 0.27}, {0.6, 0, 0.3}, 0.004, 0.002)});
  BOOST_TEST(join(set)[3].parent == 1u);
}

BOOST_AUTO_TEST_CASE(at_a_fork_the_straight_branch_goes_on)
{
  // The stem was fitted around the fork; its straight continuation is thinner and shorter.
  Axis bent = straight({0, 0, 0}, {0, 0, 1}, 0.03, 0.03);
  const Axis side = straight({0.03, 0, 1.03}, {1, 0, 2}, 0.02, 0.01);
  bent.insert(bent.end(), side.begin(), side.end());
  const Axis_set set = set_of({bent, straight({0, 0, 1.05}, {0, 0, 1.6}, 0.018, 0.01)});
  const Branch_tree tree = tree_of(set);
  BOOST_TEST_REQUIRE(tree.branches.size() == 2u);
  BOOST_TEST(std::abs(tree.nodes[tree.branches[0].nodes.back()].point.x()) < 1e-9);
  BOOST_TEST(std::abs(tree.nodes[tree.branches[1].nodes.back()].point.x() - 1) < 1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(regrouped_axes)

BOOST_AUTO_TEST_CASE(branches_that_were_mixed_up_at_a_crossing_find_their_own_parents)
{
  // Two branches of one stem cross; the first fit switches from one to the other.
  const Vec3 a0(0.06, 0, 0.4), b0(0.06, 0, 1.4), x(0.5, 0, 0.9), a1(0.95, 0, 1.4), b1(0.95, 0, 0.4);
  Axis mixed = straight(a0, x, 0.012, 0.01);
  const Axis rest = straight(x, b1, 0.01, 0.005);
  mixed.insert(mixed.end(), rest.begin() + 1, rest.end());
  Axis_set set = set_of({stem,
                         mixed,
                         straight(b0, x + Vec3(-0.02, 0, 0.02), 0.012, 0.01),
                         straight(x + Vec3(0.02, 0, 0.02), a1, 0.01, 0.005)});
  const std::size_t points = set.axis_of_point.size();
  const Branch_tree first = tree_of(set);
  regroup_axes(first, set);
  BOOST_TEST(set.axes.size() == 4u);
  std::size_t counted = 0;
  for (const Fitted_axis& axis : set.axes)
    counted += axis.number_of_points;
  BOOST_TEST(counted == points);
  for (std::size_t i = 0; i < points; ++i) {
    BOOST_TEST_REQUIRE(set.axis_of_point[i] < set.axes.size());
    BOOST_TEST(set.segment_of_point[i] + 1 < set.axes[set.axis_of_point[i]].axis.size());
  }
  // The part beyond the crossing is a separate axis with its base at the crossing.
  const auto ends_at = [&](const Vec3& p) {
    for (Index a = 0; a < set.axes.size(); ++a)
      if ((set.axes[a].axis.back().point - p).norm() < 1e-9)
        return a;
    return none;
  };
  BOOST_TEST_REQUIRE(ends_at(b1) != none);
  BOOST_TEST((set.axes[ends_at(b1)].axis.front().point - x).norm() < 0.05);
  BOOST_TEST_REQUIRE(ends_at(a1) != none);
  BOOST_TEST((set.axes[ends_at(a1)].axis.front().point - a0).norm() < 1e-9);
  BOOST_TEST(tree_of(set).branches.size() == 3u);
}

BOOST_AUTO_TEST_CASE(axes_out_of_reach_stay)
{
  Axis_set set = set_of({stem, straight({50, 0, 0}, {50, 0, 1}, 0.05, 0.04)});
  const Branch_tree tree = tree_of(set);
  BOOST_TEST(tree.number_of_unreached_axes == 1u);
  regroup_axes(tree, set);
  BOOST_TEST_REQUIRE(set.axes.size() == 2u);
  BOOST_TEST(set.axes[1].number_of_points == 20u);
  BOOST_TEST(set.axes[1].axis.front().point.x() == 50);
  BOOST_TEST(set.axis_of_point.back() == 1u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_join_axes
