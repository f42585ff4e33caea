// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pieces of one branch are joined to one axis; stubs are removed.

#include <pcs/skeleton/branching/fuse_axes.h>
#include <pcs/skeleton/branching/prune_stubs.h>
#include <pcs/skeleton/branching/split_unreachable_axes.h>
#include <support/axes.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace test_fuse_axes {

using namespace pcs::skeleton;

namespace {

using pcs_test::set_of;
constexpr double spacing = 0.01;

Axis straight(const Vec3& from, const Vec3& to, double radius)
{
  return pcs_test::straight_axis(from, to, 10, radius, radius);
}

std::size_t fuse(Axis_set& set)
{
  return fuse_axes<CGAL::Sequential_tag>(spacing, Fusion_options(), set);
}

} // namespace

BOOST_AUTO_TEST_SUITE(fused_axes)

BOOST_AUTO_TEST_CASE(pieces_on_both_sides_of_a_gap_become_one)
{
  Axis_set set =
      set_of({straight({0, 0, 0}, {0, 0, 0.5}, 0.01), straight({0, 0, 0.55}, {0, 0, 1}, 0.01)});
  set.axes[0].parent = 1; // an axis cannot be its own parent
  BOOST_TEST(fuse(set) == 1u);
  BOOST_TEST_REQUIRE(set.axes.size() == 1u);
  BOOST_TEST(set.axes[0].parent == none);
  const Axis& axis = set.axes[0].axis;
  BOOST_TEST(axis.size() == 22u);
  BOOST_TEST(set.axes[0].number_of_points == 20u);
  for (std::size_t k = 1; k < axis.size(); ++k)
    BOOST_TEST(axis[k].point.z() > axis[k - 1].point.z());
  for (std::size_t i = 0; i < 20; ++i) {
    BOOST_TEST(set.axis_of_point[i] == 0u);
    BOOST_TEST(set.segment_of_point[i] == i + (i < 10 ? 0 : 1));
  }
}

BOOST_AUTO_TEST_CASE(a_piece_that_was_found_from_its_tip_is_turned_round)
{
  // Both begin at a crossing object; the longer one determines the direction.
  Axis_set set =
      set_of({straight({0, 0, 0.5}, {0, 0, 0.2}, 0.01), straight({0, 0, 0.52}, {0, 0, 1.5}, 0.01)});
  BOOST_TEST(fuse(set) == 1u);
  BOOST_TEST_REQUIRE(set.axes.size() == 1u);
  const Axis& axis = set.axes[0].axis;
  BOOST_TEST(std::abs(axis.front().point.z() - 0.2) < 1e-12);
  BOOST_TEST(std::abs(axis.back().point.z() - 1.5) < 1e-12);
  BOOST_TEST(set.axes[0].direction < 1);
  BOOST_TEST(set.segment_of_point[0] == 9u);
  BOOST_TEST(set.segment_of_point[9] == 0u);
}

BOOST_AUTO_TEST_CASE(what_was_fused_by_its_bases_comes_apart_where_nothing_reaches_it)
{
  const Axis_set before = set_of({straight({0, 0, 0.5}, {0, 0, 0.2}, 0.01),
                                  straight({0, 0, 0.52}, {0, 0, 1.5}, 0.01),
                                  straight({-0.5, 0.03, 0.51}, {0.5, 0.03, 0.51}, 0.01)});
  Scan scan;
  for (std::size_t i = 0; i < before.axis_of_point.size(); ++i)
    scan.points.push_back(
        before.axes[before.axis_of_point[i]].axis[before.segment_of_point[i]].point);
  scan.search = std::make_unique<pcs::neighborhood::Nearest_neighbors>(scan.points);
  Axis_set set = before;
  BOOST_TEST(fuse(set) == 1u);
  BOOST_TEST_REQUIRE(set.axes.size() == 2u);
  BOOST_TEST(set.axes[0].meeting == 11u);
  std::vector<Joint> joints(2);
  joints[0].parent = 1;
  BOOST_TEST(split_unreachable_axes(scan, 0.1, joints, {1}, set) == 0u); // reachable
  BOOST_TEST(split_unreachable_axes(scan, 0.1, {Joint(), Joint()}, {0}, set) == 0u);
  BOOST_TEST(split_unreachable_axes(scan, 0.02, {Joint(), Joint()}, {1}, set) == 0u); // unreachable
  BOOST_TEST(split_unreachable_axes(scan, 0.1, {Joint(), Joint()}, {1}, set) == 1u);
  BOOST_TEST_REQUIRE(set.axes.size() == 3u);
  for (const std::size_t a : {0u, 2u}) {
    const Fitted_axis& old = before.axes[a == 0 ? 0 : 1];
    BOOST_TEST_REQUIRE(set.axes[a].axis.size() == old.axis.size());
    for (std::size_t k = 0; k < old.axis.size(); ++k)
      BOOST_TEST(set.axes[a].axis[k].point == old.axis[k].point);
    BOOST_TEST(set.axes[a].number_of_points == old.number_of_points);
    BOOST_TEST(set.axes[a].meeting == 0u);
  }
  for (std::size_t i = 0; i < before.axis_of_point.size(); ++i) {
    const Index a = before.axis_of_point[i];
    BOOST_TEST(set.axis_of_point[i] == (a == 0 ? 0u : a == 1 ? 2u : 1u));
    BOOST_TEST(set.segment_of_point[i] == before.segment_of_point[i]);
  }
}

BOOST_AUTO_TEST_CASE(pieces_that_bend_or_miss_stay_apart)
{
  const Axis below = straight({0, 0, 0}, {0, 0, 0.5}, 0.01);
  for (const Axis& other : {straight({0, 0, 0.52}, {0.5, 0, 0.6}, 0.01), // a bend
                            straight({0.1, 0, 0.55}, {0.1, 0, 1}, 0.01), // beside the line
                            straight({0, 0, 0.9}, {0, 0, 1.4}, 0.01)}) { // too distant
    Axis_set set = set_of({below, other});
    BOOST_TEST(fuse(set) == 0u);
    BOOST_TEST(set.axes.size() == 2u);
    BOOST_TEST(set.axis_of_point[15] == 1u);
  }
}

BOOST_AUTO_TEST_CASE(twigs_on_opposite_sides_of_a_stem_stay_apart)
{
  Axis_set set = set_of({straight({0, 0, 0}, {0, 0, 1}, 0.05),
                         straight({0.05, 0, 0.5}, {0.5, 0, 0.5}, 0.01),
                         straight({-0.05, 0, 0.5}, {-0.5, 0, 0.5}, 0.01)});
  BOOST_TEST(fuse(set) == 0u);
  BOOST_TEST(set.axes.size() == 3u);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(pruned_stubs)

BOOST_AUTO_TEST_CASE(short_branches_go_and_their_points_stay_with_the_parent)
{
  Branch_tree tree;
  const auto add = [&](const Vec3& p, Index parent, Index branch) {
    Branch_node node;
    node.point = p;
    node.radius = 0.01;
    node.parent = parent;
    node.branch = branch;
    if (branch == tree.branches.size()) {
      Branch b;
      b.parent = parent == none ? none : tree.nodes[parent].branch;
      tree.branches.push_back(b);
    }
    tree.branches[branch].nodes.push_back(static_cast<Index>(tree.nodes.size()));
    tree.node_of_point.push_back(static_cast<Index>(tree.nodes.size()));
    tree.nodes.push_back(node);
  };
  add({0, 0, 0}, none, 0);
  add({0, 0, 1}, 0, 0);
  add({0.03, 0, 1}, 1, 1); // leaves its parent by two spacings
  add({0, 0, 2}, 1, 0);
  add({0.3, 0, 2}, 3, 2);
  BOOST_TEST(prune_stubs(spacing, Stub_options(), tree) == 1u);
  BOOST_TEST(tree.branches.size() == 2u);
  BOOST_TEST(tree.nodes.size() == 4u);
  BOOST_TEST(tree.nodes[3].parent == 2u);
  BOOST_TEST(tree.nodes[3].branch == 1u);
  BOOST_TEST(tree.branches[1].nodes.front() == 3u);
  BOOST_TEST(tree.node_of_point[2] == 1u);
  BOOST_TEST(tree.node_of_point[4] == 3u);
  BOOST_TEST(prune_stubs(spacing, Stub_options(), tree) == 0u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_fuse_axes
