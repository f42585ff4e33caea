// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of grouping nodes into branches.

#include <pcs/core/assign_branches.h>
#include <support/trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <vector>

namespace test_assign_branches {

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

namespace {

std::vector<std::size_t> branches_of_nodes(Tree tree)
{
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    tree[v].branch = 99;
  pcs::assign_branches<Kernel>(tree);
  std::vector<std::size_t> result;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    result.push_back(tree[v].branch);
  return result;
}

} // namespace

BOOST_AUTO_TEST_SUITE(assign_branches)

BOOST_AUTO_TEST_CASE(the_thickest_child_continues_the_branch)
{
  const Tree tree = pcs_test::make_small_tree<Kernel>();
  BOOST_TEST((branches_of_nodes(tree) == std::vector<std::size_t>{0, 0, 0, 1, 1, 1, 2, 2}));
  Tree copy = tree;
  copy[boost::graph_bundle].branches.clear();
  pcs::assign_branches<Kernel>(copy);
  const auto& branches = copy[boost::graph_bundle].branches;
  BOOST_TEST(branches.size() == 3u);
  BOOST_TEST(branches[0].parent == pcs::npos);
  BOOST_TEST(branches[2].parent == 1u);
  BOOST_TEST(branches[2].order == 2);
  BOOST_TEST(branches[2].id == 2u);
}

BOOST_AUTO_TEST_CASE(among_equally_thick_children_the_longest_way_to_a_tip_decides)
{
  const std::vector<pcs_test::Row> rows = {{pcs::npos, 0, 0, 0, 0, 1},
                                           {0, 0, 0, 0, 1, 0.5},
                                           {0, 0, 1, 0, 1, 0.5},
                                           {2, 0, 1, 0, 2, 0.1}};
  BOOST_TEST((branches_of_nodes(pcs_test::make_tree<Kernel>(rows)) ==
              std::vector<std::size_t>{0, 1, 0, 0}));
}

BOOST_AUTO_TEST_CASE(equal_children_are_decided_by_their_number)
{
  const std::vector<pcs_test::Row> rows = {{pcs::npos, 0, 0, 0, 0, 1},
                                           {0, 0, -1, 0, 1, 0.5},
                                           {0, 0, 1, 0, 1, 0.5}};
  BOOST_TEST(
      (branches_of_nodes(pcs_test::make_tree<Kernel>(rows)) == std::vector<std::size_t>{0, 0, 1}));
}

BOOST_AUTO_TEST_CASE(what_is_no_tree_is_refused_and_unchanged)
{
  Tree two_parents = pcs_test::make_small_tree<Kernel>();
  add_edge(2, 5, two_parents);
  BOOST_CHECK_THROW(pcs::assign_branches<Kernel>(two_parents), pcs::Invalid_input);
  BOOST_TEST(two_parents[5].branch == 1u);

  Tree loose = pcs_test::make_small_tree<Kernel>();
  remove_edge(4, 6, loose);
  BOOST_CHECK_THROW(pcs::assign_branches<Kernel>(loose), pcs::Invalid_input);

  Tree cycle = pcs_test::make_small_tree<Kernel>();
  add_edge(7, 0, cycle);
  BOOST_CHECK_THROW(pcs::assign_branches<Kernel>(cycle), pcs::Invalid_input);

  Tree empty;
  pcs::assign_branches<Kernel>(empty);
  BOOST_TEST(empty[boost::graph_bundle].branches.empty());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_assign_branches
