// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of pruning, turning and lengthening branches.

#include <pcs/core/Tree_measures.h>
#include <pcs/generators/edit_branches.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace test_edit_branches {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;
using Point_3 = Kernel::Point_3;
using Vector_3 = Kernel::Vector_3;

namespace {

bool is_near(const Point_3& a, const Point_3& b)
{
  return std::sqrt(CGAL::squared_distance(a, b)) < 1e-12;
}

} // namespace

BOOST_AUTO_TEST_SUITE(edit_branches)

BOOST_AUTO_TEST_CASE(pruning_takes_what_hangs_on_the_branch_and_keeps_ids)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  const Tree without_twig = pcs::prune_branch(tree, 2);
  BOOST_TEST(num_vertices(without_twig) == 6u);
  const Tree bare = pcs::prune_branch(tree, 1);
  BOOST_TEST(num_vertices(bare) == 3u);
  BOOST_TEST(bare[boost::graph_bundle].branches.size() == 1u);

  // Later branches move up; their ids do not change.
  Tree more = tree;
  more[boost::graph_bundle].branches.push_back({0, 1, 3});
  pcs::Tree_node<Kernel> node = more[2];
  node.branch = 3;
  add_edge(2, add_vertex(node, more), more);
  node.point = Point_3(-1, 0, 2);
  add_edge(8, add_vertex(node, more), more);
  const Tree pruned = pcs::prune_branch(more, 1);
  BOOST_TEST_REQUIRE(num_vertices(pruned) == 5u);
  BOOST_TEST(pruned[4].branch == 1u);
  BOOST_TEST(pruned[boost::graph_bundle].branches[1].id == 3u);
  BOOST_TEST(pruned[boost::graph_bundle].branches[1].parent == 0u);
  BOOST_TEST((pruned[4].point == Point_3(-1, 0, 2)));
  BOOST_TEST(pcs::parent_node(4, pruned) == 3u);
  BOOST_CHECK_THROW(pcs::prune_branch(pruned, 1), pcs::Invalid_input); // already removed
}

BOOST_AUTO_TEST_CASE(turning_carries_the_subtree_and_changes_no_length)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  const Tree before = tree;
  tree[5].major_axis = Vector_3(1, 0, 0);
  pcs::turn_branch(tree, 1, Vector_3(0, 0, 2), CGAL_PI / 2); // about z through (0, 0, 1)
  BOOST_TEST(is_near(tree[3].point, Point_3(0, 0, 1)));
  BOOST_TEST(is_near(tree[5].point, Point_3(0, 1, 1.5)));
  BOOST_TEST(is_near(tree[7].point, Point_3(-0.4, 0.5, 1.25)));
  BOOST_TEST(is_near(Point_3(0, 0, 0) + tree[5].major_axis, Point_3(0, 1, 0)));
  BOOST_TEST((tree[2].point == before[2].point));
  BOOST_TEST(pcs::measure_tree(tree).length == pcs::measure_tree(before).length,
             boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(lengthening_scales_the_branch_and_moves_its_twigs)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  pcs::lengthen_branch(tree, 1, 2);
  BOOST_TEST(is_near(tree[3].point, Point_3(0, 0, 1)));
  BOOST_TEST(is_near(tree[4].point, Point_3(1, 0, 1.5)));
  BOOST_TEST(is_near(tree[5].point, Point_3(2, 0, 2)));
  BOOST_TEST(is_near(tree[6].point, Point_3(1, 0, 1.5)));
  BOOST_TEST(is_near(tree[7].point, Point_3(1, 0.4, 1.5))); // its length is preserved
  BOOST_TEST(tree[5].radius == 0.03);
}

BOOST_AUTO_TEST_CASE(the_trunk_may_be_lengthened_but_not_pruned)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  pcs::lengthen_branch(tree, 0, 1.5);
  BOOST_TEST(is_near(tree[2].point, Point_3(0, 0, 3)));
  BOOST_TEST(is_near(tree[7].point, Point_3(0.5, 0.4, 1.75)));
  BOOST_CHECK_THROW(pcs::prune_branch(tree, 0), pcs::Invalid_input);
}

BOOST_AUTO_TEST_CASE(wrong_values_are_refused)
{
  Tree tree = pcs_test::make_small_tree<Kernel>();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BOOST_CHECK_THROW(pcs::turn_branch(tree, 9, Vector_3(0, 0, 1), 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::turn_branch(tree, pcs::npos, Vector_3(0, 0, 1), 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::turn_branch(tree, 1, Vector_3(0, 0, 0), 1), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::turn_branch(tree, 1, Vector_3(0, 0, 1), nan), pcs::Invalid_input);
  for (const double factor : {0.0, -1.0, nan})
    BOOST_CHECK_THROW(pcs::lengthen_branch(tree, 1, factor), pcs::Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_edit_branches
