// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the younger shapes of a tree.

#include <pcs/core/Tree_measures.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/tree_at_age.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <vector>

namespace test_tree_at_age {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

BOOST_AUTO_TEST_SUITE(tree_at_age)

BOOST_AUTO_TEST_CASE(at_the_age_1_nothing_has_changed)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  std::vector<std::size_t> old;
  const Tree same = pcs::tree_at_age(tree, 1, old);
  BOOST_TEST_REQUIRE(num_vertices(same) == num_vertices(tree));
  for (std::size_t v = 0; v < num_vertices(same); ++v) {
    BOOST_TEST_REQUIRE(old[v] != pcs::npos);
    BOOST_TEST((same[v].point == tree[old[v]].point));
    BOOST_TEST(std::abs(same[v].radius - tree[old[v]].radius) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(a_straight_trunk_is_as_long_as_computed_by_hand)
{
  // Growth decreases linearly: at half the age the length is 1 - 0.25 = 0.75.
  const Tree tree = pcs_test::make_tree<Kernel>(
      {{pcs::npos, 0, 0, 0, 0, 0.3}, {0, 0, 0, 0, 1, 0.2}, {1, 0, 0, 0, 2, 0.1}});
  std::vector<std::size_t> old;
  const Tree young = pcs::tree_at_age(tree, 0.5, old);
  BOOST_TEST_REQUIRE(num_vertices(young) == 3u);
  BOOST_TEST(young[2].point.z() == 1.5, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(old[2] == pcs::npos);
  // The root has the age of the tree: half of the increase over the tip's radius of 0.1.
  BOOST_TEST(young[0].radius == 0.2, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(young[2].radius == 0.1, boost::test_tools::tolerance(1e-12));
}

// The branch is stored in front of the trunk. Half axes are in proportion to the radii.
BOOST_AUTO_TEST_CASE(a_slanted_tree_is_as_computed_by_hand)
{
  Tree tree = pcs_test::make_tree<Kernel>({{pcs::npos, 1, 0, 0, 0, 0.3},
                                           {0, 1, 2, 1, 2, 0.2},
                                           {1, 1, 6, 3, 6, 0.1},
                                           {1, 0, 3, 3, 4, 0.05},
                                           {3, 0, 5, 7, 8, 0.05}});
  const double major[] = {0.4, 0.3, 0.2}, minor[] = {0.2, 0.1, 0.05};
  for (std::size_t v = 0; v < 3; ++v) {
    tree[v].major_radius = major[v];
    tree[v].minor_radius = minor[v];
  }
  std::vector<std::size_t> old;
  const Tree young = pcs::tree_at_age(tree, 0.75, old);
  BOOST_TEST_REQUIRE(num_vertices(young) == 5u);
  const std::vector<std::size_t> expected_old{0, 1, pcs::npos, 3, pcs::npos};
  BOOST_TEST((old == expected_old));

  const auto is_close = [](const auto& node, double x, double y, double z, double r) {
    return std::hypot(node.point.x() - x, node.point.y() - y, node.point.z() - z) < 1e-12 &&
           std::abs(node.radius - r) < 1e-12;
  };
  // The trunk of length 9 has the length 9 * 0.75 * 1.25: 29/32 of its second edge.
  const double part = 29.0 / 32;
  BOOST_TEST(is_close(young[0], 0, 0, 0, 0.25));
  BOOST_TEST(is_close(young[2], 2 + 4 * part, 1 + 2 * part, 2 + 4 * part, 0.1));
  BOOST_TEST(std::abs(young[0].major_radius - 0.4 * 0.25 / 0.3) < 1e-12);
  BOOST_TEST(std::abs(young[0].minor_radius - 0.2 * 0.25 / 0.3) < 1e-12);
  const double radius = 0.2 - 0.1 * part; // between the nodes, before it is that of the tip
  BOOST_TEST(std::abs(young[2].major_radius - (0.3 - 0.1 * part) * 0.1 / radius) < 1e-12);
  BOOST_TEST(std::abs(young[2].minor_radius - (0.1 - 0.05 * part) * 0.1 / radius) < 1e-12);

  // The tip passed the base of the branch, a third of the trunk, at the age 1 - sqrt(2/3).
  const double birth = 1 - std::sqrt(2.0 / 3), time = (0.75 - birth) / (1 - birth);
  const double length = time * (2 - time); // of the branch, in the old length
  BOOST_TEST(is_close(young[1], 2, 1, 2, 0.1 + 0.1 * time));
  BOOST_TEST(is_close(young[4], 3 + 2 * length, 3 + 4 * length, 4 + 4 * length, 0.05));

  const auto& branches = young[boost::graph_bundle].branches;
  BOOST_TEST_REQUIRE(branches.size() == 2u);
  BOOST_TEST(branches[0].id == 1u);
  BOOST_TEST(branches[0].parent == pcs::npos);
  BOOST_TEST(branches[1].id == 0u);
  BOOST_TEST(branches[1].parent == 0u);
  BOOST_TEST(young[boost::graph_bundle].root == 0u);
}

BOOST_AUTO_TEST_CASE(axes_are_beginnings_of_the_older_ones_and_ids_stay)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::broadleaf_habit());
  const auto nodes = pcs::nodes_by_branch(tree);
  double length = 0, volume = 0;
  std::size_t branches = 0;
  for (const double age : {0.1, 0.3, 0.6, 0.8, 0.95}) {
    std::vector<std::size_t> old;
    const Tree young = pcs::tree_at_age(tree, age, old);
    const auto& bundle = young[boost::graph_bundle];
    const auto young_nodes = pcs::nodes_by_branch(young);
    std::set<std::size_t> ids;
    for (std::size_t b = 0; b < young_nodes.size(); ++b) {
      ids.insert(bundle.branches[b].id);
      const auto& of_old = nodes[bundle.branches[b].id];
      for (std::size_t i = 0; i < young_nodes[b].size(); ++i) {
        const std::size_t v = young_nodes[b][i];
        if (old[v] == pcs::npos) {
          BOOST_TEST(i + 1 == young_nodes[b].size()); // only tips are new
          continue;
        }
        BOOST_TEST(old[v] == of_old[i]);
        BOOST_TEST((young[v].point == tree[old[v]].point));
        BOOST_TEST(young[v].radius <= tree[old[v]].radius * (1 + 1e-12));
        BOOST_TEST(young[v].radius > 0);
      }
    }
    BOOST_TEST(ids.size() == bundle.branches.size());
    const auto m = pcs::measure_tree(young);
    BOOST_TEST(m.length > length);
    BOOST_TEST(m.volume > volume);
    BOOST_TEST(bundle.branches.size() >= branches);
    length = m.length;
    volume = m.volume;
    branches = bundle.branches.size();
  }
  BOOST_TEST(branches > 500u);
}

BOOST_AUTO_TEST_CASE(two_steps_back_have_the_topology_of_the_whole_way)
{
  Tree tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  const Tree a = pcs::tree_at_age(tree, 0.5);
  const Tree b = pcs::tree_at_age(tree, 0.7);
  std::set<std::size_t> ids;
  for (const auto& branch : b[boost::graph_bundle].branches)
    ids.insert(branch.id);
  for (const auto& branch : a[boost::graph_bundle].branches)
    BOOST_TEST(ids.count(branch.id) == 1u);
}

BOOST_AUTO_TEST_CASE(ages_outside_the_life_are_refused)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  for (const double age : {0.0, -1.0, 1.01, std::numeric_limits<double>::quiet_NaN()})
    BOOST_CHECK_THROW(pcs::tree_at_age(tree, age), pcs::Invalid_input);
  BOOST_TEST(num_vertices(pcs::tree_at_age(Tree(), 0.5)) == 0u);
}

BOOST_AUTO_TEST_CASE(a_minimal_kernel_will_do)
{
  pcs::Tree_skeleton<pcs_test::Kernel_archetype> tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  BOOST_TEST(num_vertices(pcs::tree_at_age(tree, 0.9)) > 100u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_tree_at_age
