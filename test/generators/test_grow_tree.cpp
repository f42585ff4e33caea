// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of growing virtual trees.

#include <pcs/core/Tree_measures.h>
#include <pcs/generators/grow_tree.h>
#include <support/trees.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/mpl/list.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace test_grow_tree {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Kernels = boost::mpl::list<CGAL::Simple_cartesian<float>,
                                 CGAL::Simple_cartesian<double>,
                                 CGAL::Exact_predicates_inexact_constructions_kernel,
                                 pcs_test::Kernel_archetype>;
namespace np = pcs::parameters;

namespace {

Tree grown(const pcs::Tree_habit& habit, int seed = 1)
{
  Tree tree;
  pcs::grow_tree(tree, habit, np::random_seed(seed));
  return tree;
}

bool are_equal(const Tree& a, const Tree& b)
{
  if (num_vertices(a) != num_vertices(b))
    return false;
  for (std::size_t v = 0; v < num_vertices(a); ++v)
    if (a[v].point != b[v].point || a[v].radius != b[v].radius ||
        a[v].major_axis != b[v].major_axis || a[v].branch != b[v].branch)
      return false;
  return true;
}

} // namespace

BOOST_AUTO_TEST_SUITE(grow_tree)

BOOST_AUTO_TEST_CASE(every_preset_is_a_sound_tree)
{
  for (const auto& [name, habit] : pcs::tree_habits())
    for (const int seed : {1, 2, 3}) {
      BOOST_TEST_CONTEXT(name << ", seed " << seed)
      {
        const Tree tree = grown(habit, seed);
        const auto& bundle = tree[boost::graph_bundle];
        const auto nodes = pcs::nodes_by_branch(tree);
        std::size_t reached = 0;
        for (std::size_t b = 0; b < nodes.size(); ++b) {
          reached += nodes[b].size();
          BOOST_TEST(nodes[b].size() >= 2u);
          BOOST_TEST(bundle.branches[b].id == b);
          const std::size_t carrier = pcs::parent_node(nodes[b][0], tree);
          if (carrier == pcs::npos) {
            BOOST_TEST(b == 0u);
            BOOST_TEST(bundle.branches[b].order == 0);
            continue;
          }
          BOOST_TEST((tree[carrier].point == tree[nodes[b][0]].point));
          BOOST_TEST(tree[nodes[b][0]].radius <= tree[carrier].radius);
          BOOST_TEST(bundle.branches[b].parent == tree[carrier].branch);
          BOOST_TEST(bundle.branches[b].order ==
                     bundle.branches[bundle.branches[b].parent].order + 1);
          BOOST_TEST(bundle.branches[b].order < habit.number_of_orders);
        }
        BOOST_TEST(reached == num_vertices(tree));
      }
    }
}

BOOST_AUTO_TEST_CASE(radius_never_grows_towards_a_tip)
{
  for (const auto& [name, habit] : pcs::tree_habits()) {
    const Tree tree = grown(habit);
    for (const auto& branch : pcs::nodes_by_branch(tree))
      for (std::size_t i = 1; i < branch.size(); ++i)
        BOOST_TEST(tree[branch[i]].radius <= tree[branch[i - 1]].radius, name);
  }
}

BOOST_AUTO_TEST_CASE(sections_are_ellipses_of_the_area_of_the_radius)
{
  const Tree tree = grown(pcs::broadleaf_habit());
  double flattest = 1;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const auto& n = tree[v];
    BOOST_TEST(n.major_radius * n.minor_radius == n.radius * n.radius,
               boost::test_tools::tolerance(1e-12));
    BOOST_TEST(n.major_axis.squared_length() == 1, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(n.radius >= pcs::broadleaf_habit().tip_radius);
    flattest = std::min(flattest, n.minor_radius / n.major_radius);
  }
  BOOST_TEST(flattest >= 0.88 - 1e-12);
  BOOST_TEST(flattest < 0.9); // of a thousand branches
}

BOOST_AUTO_TEST_CASE(a_seed_gives_one_tree_and_another_seed_another_one)
{
  BOOST_TEST(are_equal(grown(pcs::fruit_habit(), 5), grown(pcs::fruit_habit(), 5)));
  BOOST_TEST(!are_equal(grown(pcs::fruit_habit(), 5), grown(pcs::fruit_habit(), 6)));
}

BOOST_AUTO_TEST_CASE(presets_look_like_their_names)
{
  // Conifer: the tip of the trunk is the highest point, and the trunk is straight.
  Tree tree = grown(pcs::conifer_habit());
  auto nodes = pcs::nodes_by_branch(tree);
  const auto top = tree[nodes[0].back()].point;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    BOOST_TEST(tree[v].point.z() <= top.z() + 0.3);
  BOOST_TEST(top.z() > 0.97 * pcs::conifer_habit().height);

  // Forked: a second stem is nearly as thick as the first.
  tree = grown(pcs::forked_habit());
  nodes = pcs::nodes_by_branch(tree);
  double thickest = 0;
  for (std::size_t b = 1; b < nodes.size(); ++b) {
    const std::size_t carrier = pcs::parent_node(nodes[b][0], tree);
    thickest = std::max(thickest, tree[nodes[b][0]].radius / tree[carrier].radius);
  }
  BOOST_TEST(thickest > 0.75);

  // Weeping: most twigs end below their bases. Broadleaf: most end above.
  for (const bool is_weeping : {true, false}) {
    tree = grown(is_weeping ? pcs::weeping_habit() : pcs::broadleaf_habit());
    nodes = pcs::nodes_by_branch(tree);
    double hanging = 0, twigs = 0;
    for (std::size_t b = 0; b < nodes.size(); ++b)
      if (tree[boost::graph_bundle].branches[b].order >= 2) {
        twigs += 1;
        hanging += tree[nodes[b].back()].point.z() < tree[nodes[b][0]].point.z() ? 1 : 0;
      }
    BOOST_TEST((is_weeping ? hanging > 0.6 * twigs : hanging < 0.4 * twigs),
               hanging << " of " << twigs);
  }
}

BOOST_AUTO_TEST_CASE(a_habit_in_another_unit_gives_the_same_tree_in_that_unit)
{
  const Tree metres = grown(pcs::fruit_habit());
  const Tree large = grown(pcs::fruit_habit().scaled(1024)); // a power of two: no rounding
  BOOST_TEST_REQUIRE(num_vertices(metres) == num_vertices(large));
  for (std::size_t v = 0; v < num_vertices(metres); ++v) {
    BOOST_TEST(large[v].point.x() == 1024 * metres[v].point.x());
    BOOST_TEST(large[v].radius == 1024 * metres[v].radius);
  }
}

BOOST_AUTO_TEST_CASE(stubs_are_short_and_blunt)
{
  pcs::Tree_habit habit = pcs::broadleaf_habit();
  habit.number_of_orders = 1;
  habit.number_of_stubs = 4;
  const Tree tree = grown(habit);
  const auto nodes = pcs::nodes_by_branch(tree);
  BOOST_TEST_REQUIRE(nodes.size() == 5u);
  for (std::size_t b = 1; b < 5; ++b)
    BOOST_TEST(tree[nodes[b].back()].radius > 0.75 * tree[nodes[b][0]].radius);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(any_kernel_will_do, K, Kernels)
{
  pcs::Tree_skeleton<K> tree;
  pcs::grow_tree(tree, pcs::fruit_habit());
  const Tree expected = grown(pcs::fruit_habit(), 0);
  BOOST_TEST_REQUIRE(num_vertices(tree) == num_vertices(expected));
  for (std::size_t v = 0; v < num_vertices(tree); v += 97)
    BOOST_TEST(std::abs(double(tree[v].point.z()) - expected[v].point.z()) < 1e-5);
}

BOOST_AUTO_TEST_CASE(senseless_habits_are_refused_and_name_the_value)
{
  const auto refuses = [](auto change, const std::string& name) {
    pcs::Tree_habit habit;
    change(habit);
    Tree tree = pcs_test::make_small_tree<Kernel>();
    std::string message = "no error";
    try {
      pcs::grow_tree(tree, habit);
    } catch (const pcs::Invalid_input& e) {
      message = e.what();
    }
    BOOST_TEST(message.find(name) != std::string::npos, name << " in " << message);
    BOOST_TEST(num_vertices(tree) == 8u);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  refuses([&](auto& h) { h.height = nan; }, "height");
  refuses([&](auto& h) { h.height = infinity; }, "height");
  refuses([&](auto& h) { h.trunk_radius = -1; }, "trunk_radius");
  refuses([&](auto& h) { h.smallest_step = 0; }, "smallest_step");
  refuses([&](auto& h) { h.largest_step = 0.001; }, "largest_step");
  refuses([&](auto& h) { h.number_of_orders = 0; }, "number_of_orders");
  refuses([&](auto& h) { h.spacing[1] = 0; }, "spacing");
  refuses([&](auto& h) { h.tropism[2] = nan; }, "tropism");
  refuses([&](auto& h) { h.insertion[0] = {1, 0.5}; }, "insertion");
  refuses([&](auto& h) { h.child_radius[1] = {0.5, 1.5}; }, "child_radius");
  refuses([&](auto& h) { h.whorl = 0; }, "whorl");
  refuses([&](auto& h) { h.flattest_section = 0; }, "flattest_section");
  refuses([&](auto& h) { h.largest_step = h.smallest_step = 1e-7; }, "more than 10000000 nodes");
}

// Independent of the compiler, which determines the order of arguments of a call.
BOOST_AUTO_TEST_CASE(a_seed_is_one_tree_everywhere)
{
  const Tree tree = grown(pcs::fruit_habit());
  double x = 0, y = 0, z = 0;
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    x += tree[v].point.x();
    y += tree[v].point.y();
    z += tree[v].point.z();
  }
  BOOST_TEST(num_vertices(tree) == 4086u);
  BOOST_TEST(x == 845.597293946, boost::test_tools::tolerance(1e-6));
  BOOST_TEST(y == -1484.93343301, boost::test_tools::tolerance(1e-6));
  BOOST_TEST(z == 7171.60074839, boost::test_tools::tolerance(1e-6));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_grow_tree
