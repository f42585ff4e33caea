// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the skeleton type.

#include <pcs/core/Tree_skeleton.h>
#include <support/trees.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/graph/graph_concepts.hpp>
#include <boost/mpl/list.hpp>
#include <boost/test/unit_test.hpp>

#include <cstddef>
#include <vector>

namespace test_Tree_skeleton {

using Kernels = boost::mpl::list<CGAL::Simple_cartesian<float>,
                                 CGAL::Simple_cartesian<double>,
                                 CGAL::Exact_predicates_inexact_constructions_kernel>;

BOOST_AUTO_TEST_SUITE(Tree_skeleton)

BOOST_AUTO_TEST_CASE_TEMPLATE(it_models_the_concepts_of_boost_graph, Kernel, Kernels)
{
  using Tree = pcs::Tree_skeleton<Kernel>;
  BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<Tree>));
  BOOST_CONCEPT_ASSERT((boost::BidirectionalGraphConcept<Tree>));
  BOOST_CONCEPT_ASSERT((boost::VertexMutableGraphConcept<Tree>));
  BOOST_CONCEPT_ASSERT((boost::EdgeMutableGraphConcept<Tree>));
  BOOST_TEST(Tree()[boost::graph_bundle].root == pcs::npos);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(branches_list_their_nodes_from_base_to_tip, Kernel, Kernels)
{
  const auto tree = pcs_test::make_small_tree<Kernel>();
  const std::vector<std::vector<std::size_t>> expected = {{0, 1, 2}, {3, 4, 5}, {6, 7}};
  BOOST_TEST((pcs::nodes_by_branch<Kernel>(tree) == expected));
  BOOST_TEST(pcs::parent_node<Kernel>(0, tree) == pcs::npos);
  BOOST_TEST(pcs::parent_node<Kernel>(6, tree) == 4u);
  BOOST_TEST(pcs::nodes_by_branch<Kernel>(pcs::Tree_skeleton<Kernel>()).empty());
}

BOOST_AUTO_TEST_CASE(property_maps_reach_the_nodes)
{
  using Kernel = CGAL::Simple_cartesian<double>;
  auto tree = pcs_test::make_small_tree<Kernel>();
  const auto radius = get(&pcs::Tree_node<Kernel>::radius, tree);
  put(radius, std::size_t(2), 0.5);
  BOOST_TEST(tree[2].radius == 0.5);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Tree_skeleton
