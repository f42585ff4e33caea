// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A trunk that turns into a thin side branch is continued to the top; other trunks are kept.

#include <pcs/core/Skeleton_report.h>
#include <pcs/skeleton/continuation/continue_hidden_trunk.h>
#include <pcs/skeleton/result/skeleton_warnings.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace test_continue_hidden_trunk {

using namespace pcs::skeleton;

namespace {

constexpr double breast_height = 1.3;

/// A tree that grows branch by branch, and the points of its crown.
struct Crown
{
  Branch_tree tree;
  Scan scan;

  Crown() { tree.branches.resize(1); }

  /// Appends nodes 0.1 apart to a branch; its first nodes continue node `seat`.
  void add(Index branch, Index seat, const Vec3& from, const Vec3& to, double r0, double r1)
  {
    const int steps = static_cast<int>(std::lround((to - from).norm() / 0.1));
    for (int k = tree.nodes.empty() || seat != none ? 0 : 1; k <= steps; ++k) {
      const double t = double(k) / steps;
      Branch_node node;
      node.point = from + t * (to - from);
      node.radius = r0 + t * (r1 - r0);
      node.is_measured = true;
      std::vector<Index>& own = tree.branches[branch].nodes;
      node.parent = own.empty() ? seat : own.back();
      node.branch = branch;
      own.push_back(static_cast<Index>(tree.nodes.size()));
      tree.nodes.push_back(node);
    }
  }
  Index add_branch(Index parent, Index seat, const Vec3& to, double r)
  {
    const auto b = static_cast<Index>(tree.branches.size());
    Branch branch;
    branch.parent = parent;
    branch.order = tree.branches[parent].order + 1;
    tree.branches.push_back(branch);
    add(b, seat, tree.nodes[seat].point, to, r, r);
    return b;
  }
  Hidden_trunk_part run(double top = 11)
  {
    tree.node_of_point.assign(scan.points.size(), none);
    tree.node_of_point.back() = static_cast<Index>(tree.nodes.size() - 1);
    return continue_hidden_trunk(
        scan,
        [](Index) { return true; },
        top,
        breast_height,
        Hidden_trunk_options(),
        tree);
  }
};

/// Makes a trunk of 6 m that turns into a horizontal branch with a twig. The crown ends at 10 m.
void turn_trunk(double thickness, Crown& crown)
{
  crown.add(0, none, Vec3(0, 0, 0), Vec3(0, 0, 6), 0.15, 0.1);
  crown.add(0, none, Vec3(0, 0, 6), Vec3(2, 0, 6.2), thickness, thickness / 2);
  const Index b = crown.add_branch(0, 40, Vec3(0, 1, 4.2), 0.01);
  crown.add_branch(b, crown.tree.branches[b].nodes.back(), Vec3(0, 1, 4.6), 0.005);
  crown.add_branch(0, 70, Vec3(1, 0.5, 6.4), 0.005);
  crown.scan.points = {Vec3(0, 0, 3), Vec3(0.3, 0, 10), Vec3(6, 0, 12), Vec3(2, 0, 6.2)};
}

double length_of(const Branch_tree& tree, Index branch)
{
  const std::vector<Index>& nodes = tree.branches[branch].nodes;
  double length = 0;
  for (std::size_t k = 1; k < nodes.size(); ++k)
    length += (tree.nodes[nodes[k]].point - tree.nodes[nodes[k - 1]].point).norm();
  return length;
}

void check_tree(const Branch_tree& tree)
{
  std::vector<int> uses(tree.nodes.size(), 0);
  for (Index b = 0; b < tree.branches.size(); ++b) {
    const Branch& branch = tree.branches[b];
    BOOST_TEST((b == 0 ? branch.parent == none : branch.parent < b));
    BOOST_TEST(branch.order == (b == 0 ? 0 : tree.branches[branch.parent].order + 1));
    for (std::size_t k = 0; k < branch.nodes.size(); ++k) {
      const Branch_node& node = tree.nodes[branch.nodes[k]];
      ++uses[branch.nodes[k]];
      BOOST_TEST(node.branch == b);
      if (k > 0)
        BOOST_TEST(node.parent == branch.nodes[k - 1]);
      else if (b > 0)
        BOOST_TEST(tree.nodes[node.parent].branch == branch.parent);
    }
  }
  BOOST_TEST(uses[0] == 1);
  for (Index v = 1; v < tree.nodes.size(); ++v) {
    BOOST_TEST(uses[v] == 1);
    BOOST_TEST(tree.nodes[v].parent < v);
    BOOST_TEST(tree.nodes[v].radius > 0);
  }
}

} // namespace

BOOST_AUTO_TEST_SUITE(hidden_trunk)

BOOST_AUTO_TEST_CASE(a_trunk_that_turns_into_a_branch_is_continued_to_the_top)
{
  Crown crown;
  turn_trunk(0.03, crown);
  const Branch_tree before = crown.tree;
  const Hidden_trunk_part part = crown.run();
  const double hidden = part.length;
  const Branch_tree& tree = crown.tree;
  check_tree(tree);
  BOOST_TEST(std::abs(hidden - 4) < 0.3);
  BOOST_TEST(std::abs(length_of(tree, 0) - 10) < 0.05);
  BOOST_TEST((tree.nodes[tree.branches[0].nodes.back()].point - Vec3(0.3, 0, 10)).norm() < 1e-12);
  BOOST_TEST(tree.branches.size() == before.branches.size() + 1);
  BOOST_TEST(tree.branches[1].order == 1);
  BOOST_TEST(std::abs(length_of(tree, 1) - 2) < 0.3);
  // the twig at the end of the former trunk is one order higher now
  BOOST_TEST(tree.branches.back().parent == 1u);
  BOOST_TEST(tree.branches.back().order == 2);
  // the point keeps its node
  const Vec3 old = before.nodes.back().point;
  BOOST_TEST((tree.nodes[tree.node_of_point.back()].point - old).norm() == 0);
  double last = 1;
  bool is_inferred = false;
  for (const Index v : tree.branches[0].nodes) {
    BOOST_TEST(tree.nodes[v].radius < last + 1e-12);
    BOOST_TEST(!(is_inferred && tree.nodes[v].is_measured)); // once hidden, up to the top
    is_inferred |= !tree.nodes[v].is_measured;
    last = tree.nodes[v].radius;
  }
  BOOST_TEST(is_inferred);
}

BOOST_AUTO_TEST_CASE(a_trunk_that_ends_at_a_thick_section_is_continued)
{
  Crown crown;
  crown.add(0, none, Vec3(0, 0, 0), Vec3(0, 0, 6), 0.15, 0.1);
  crown.scan.points = {Vec3(0.3, 0, 10)};
  const Hidden_trunk_part part = crown.run();
  const double hidden = part.length;
  check_tree(crown.tree);
  BOOST_TEST(crown.tree.branches.size() == 1u);
  BOOST_TEST(hidden > 3.9);
  // a cone of the radius at the end
  BOOST_TEST(std::abs(part.volume / (3.14159265 / 3 * 0.1 * 0.1 * hidden) - 1) < 0.2);
  BOOST_TEST(std::abs(length_of(crown.tree, 0) - 10) < 0.05);
}

BOOST_AUTO_TEST_CASE(a_visible_trunk_is_kept)
{
  Crown crown;
  crown.add(0, none, Vec3(0, 0, 0), Vec3(0, 0, 10), 0.15, 0.005);
  crown.scan.points = {Vec3(0.3, 0, 10.2)};
  BOOST_TEST(crown.run().length == 0);
  BOOST_TEST(crown.tree.nodes.size() == 101u);
}

BOOST_AUTO_TEST_CASE(a_fork_carries_the_area_of_the_trunk)
{
  // radii of both limbs: those of two pipes of half the area
  Crown crown;
  crown.add(0, none, Vec3(0, 0, 0), Vec3(0, 0, 3), 0.15, 0.14);
  crown.add(0, none, Vec3(0, 0, 3), Vec3(2, 0, 6), 0.1, 0.03);
  crown.add_branch(0, 30, Vec3(-2, 0, 6), 0.1);
  crown.scan.points = {Vec3(0, 0, 10)};
  BOOST_TEST(crown.run().length == 0);
}

BOOST_AUTO_TEST_CASE(without_points_above_nothing_is_inferred)
{
  Crown crown;
  turn_trunk(0.03, crown);
  crown.scan.points = {Vec3(3, 0, 6.5)};
  const std::size_t before = crown.tree.nodes.size();
  BOOST_TEST(crown.run().length == 0);
  BOOST_TEST(crown.tree.nodes.size() == before);
}

BOOST_AUTO_TEST_CASE(a_tree_below_breast_height_is_kept)
{
  Crown crown;
  crown.add(0, none, Vec3(0, 0, 0), Vec3(0, 0, 1), 0.05, 0.04);
  crown.scan.points = {Vec3(0, 0, 3)};
  BOOST_TEST(crown.run().length == 0);
  Branch_tree empty;
  BOOST_TEST(continue_hidden_trunk(
                 crown.scan,
                 [](Index) { return true; },
                 11,
                 breast_height,
                 Hidden_trunk_options(),
                 empty)
                 .length == 0);
}

BOOST_AUTO_TEST_CASE(thick_wood_aside_does_not_continue_a_trunk)
{
  // 0.8 of the area continues, but not in the direction of the trunk
  Crown crown;
  turn_trunk(0.09, crown);
  BOOST_TEST(std::abs(crown.run().length - 4) < 0.3);
  check_tree(crown.tree);
}

BOOST_AUTO_TEST_CASE(a_leaning_trunk_keeps_its_direction)
{
  const Vec3 along = Vec3(0.3, 0, 1).normalized();
  Crown crown;
  crown.add(0, none, Vec3::Zero(), 6 * along, 0.15, 0.1);
  crown.add(0, none, 6 * along, 6 * along + Vec3(-2, 0, 0), 0.01, 0.005);
  // the second point is higher, but not in the cone
  crown.scan.points = {10 * along, Vec3(-3, 0, 10.5)};
  BOOST_TEST(std::abs(crown.run().length - 4) < 0.3);
  BOOST_TEST((crown.tree.nodes[crown.tree.branches[0].nodes.back()].point - 10 * along).norm() <
             1e-12);
}

BOOST_AUTO_TEST_CASE(a_trunk_may_end_at_breast_height)
{
  // false wood leads away from the stem, first below breast height, then above
  for (const double height : {1.2, 1.5}) {
    Crown crown;
    crown.add(0, none, Vec3::Zero(), Vec3(0, 0, height), 0.15, 0.15);
    crown.add(0, none, Vec3(0, 0, height), Vec3(-1, 0, height + 0.5), 0.02, 0.02);
    crown.scan.points = {Vec3(0, 0, 8), Vec3(-2.5, 0, 5)};
    const Hidden_trunk_part part = crown.run();
    check_tree(crown.tree);
    BOOST_TEST(
        (crown.tree.nodes[crown.tree.branches[0].nodes.back()].point - Vec3(0, 0, 8)).norm() <
        1e-12);
    BOOST_TEST(part.volume > 0.1); // a cone of 0.15 m is 0.16 m3
  }
}

BOOST_AUTO_TEST_CASE(a_short_part_is_not_inferred)
{
  Crown crown;
  crown.add(0, none, Vec3(0, 0, 0), Vec3(0, 0, 6), 0.15, 0.1);
  crown.scan.points = {Vec3(0, 0, 7)}; // ten radii above the end
  BOOST_TEST(crown.run().length == 0);
}

BOOST_AUTO_TEST_CASE(the_report_names_the_inferred_length)
{
  pcs::Skeleton_report report;
  report.by_order.resize(1);
  report.by_order[0].length = report.height = report.max_root_distance = 10;
  report.by_order[0].volume = 0.1;
  report.hidden_trunk_length = 4;
  bool is_named = false;
  for (const std::string& sentence : pcs::warnings(report))
    is_named |= sentence.find("the upper 4 of the trunk") != std::string::npos;
  BOOST_TEST(is_named);
  report.spread.number_of_copies = 4;
  report.estimates.volume = 0.1;
  const double without = pcs::standard_errors(report).volume;
  report.hidden_trunk_volume = 0.04;
  BOOST_TEST(std::abs(pcs::standard_errors(report).volume - std::hypot(without, 0.02)) < 1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_continue_hidden_trunk
