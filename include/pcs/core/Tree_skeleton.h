// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The skeleton of a tree as a graph of Boost: nodes with position and radius, grouped in branches.

#ifndef PCS_CORE_TREE_SKELETON_H
#define PCS_CORE_TREE_SKELETON_H

#include <boost/graph/adjacency_list.hpp>
#include <boost/range/iterator_range.hpp>

#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsCoreRef
//! the index that denotes no node or no branch
constexpr std::size_t npos = std::numeric_limits<std::size_t>::max();

/*!
  \ingroup PkgPcsCoreRef
  \brief A node of a tree skeleton: a point on a branch axis with the cross-section there.

  \tparam Kernel a kernel of CGAL, or any class with `FT`, `Point_3` and `Vector_3`
*/
template <class Kernel>
struct Tree_node
{
  using FT = typename Kernel::FT;
  using Point_3 = typename Kernel::Point_3;
  using Vector_3 = typename Kernel::Vector_3;

  Point_3 point = Point_3(FT(0), FT(0), FT(0));
  FT radius = FT(0);        //!< of the circle with the area of the cross-section [L]
  FT radius_error = FT(0);  //!< standard error of `radius`; 0 if unknown [L]
  bool is_measured = false; //!< whether the radius was fitted to points, not predicted by a model

  FT major_radius = FT(0); //!< half the longest diameter of the cross-section [L]
  FT minor_radius = FT(0); //!< half the shortest diameter; both equal `radius` for a circle [L]
  //! unit vector along the longest diameter; the null vector for a circle or if unknown
  Vector_3 major_axis = Vector_3(FT(0), FT(0), FT(0));

  std::size_t branch = 0; //!< index in `Tree_bundle::branches`
};

/*!
  \ingroup PkgPcsCoreRef
  \brief A branch: a chain of nodes from the axis of its parent to its tip.

  The first node of a branch lies on the axis of its parent and has the radius of the branch, not
  of the parent. The edge that leads to it may have the length 0.
*/
struct Tree_branch
{
  //! index of the parent branch, `npos` for the trunk
  std::size_t parent = npos;
  //! 0 for the trunk, 1 for branches on it, and so on
  int order = 0;
  //! identifier of this branch in all shapes of the same tree; `npos` if it has none
  std::size_t id = npos;
};

//! \ingroup PkgPcsCoreRef
//! the properties of a tree skeleton that belong to no single node
struct Tree_bundle
{
  std::size_t root = npos; //!< the lowest node of the trunk; `npos` in a graph without nodes
  std::vector<Tree_branch> branches;
};

/*!
  \ingroup PkgPcsCoreRef
  \brief The default type of tree skeletons: a directed graph with edges from parent to child.

  `tree[v].point` is the position of node `v`, `tree[boost::graph_bundle].root` the root. Property
  maps are obtained from `get(&pcs::Tree_node<Kernel>::radius, tree)`. Algorithms of pcs accept any
  model of the concepts of Boost.Graph with maps for position and radius.
*/
template <class Kernel>
using Tree_skeleton = boost::adjacency_list<boost::vecS,
                                            boost::vecS,
                                            boost::bidirectionalS,
                                            Tree_node<Kernel>,
                                            boost::no_property,
                                            Tree_bundle>;

namespace internal {

template <class Graph>
struct Is_tree_skeleton : std::false_type
{
};
template <class Kernel>
struct Is_tree_skeleton<Tree_skeleton<Kernel>> : std::true_type
{
};

} // namespace internal

/*!
  \ingroup PkgPcsCoreRef
  \brief returns the parent of node `v`, or `npos` for the root.
*/
template <class Kernel>
std::size_t parent_node(std::size_t v, const Tree_skeleton<Kernel>& tree)
{
  const auto edges = in_edges(v, tree);
  return edges.first == edges.second ? npos : source(*edges.first, tree);
}

/*!
  \ingroup PkgPcsCoreRef
  \brief returns the nodes of every branch, from base to tip.

  The result has one list for each element of `Tree_bundle::branches`. Nodes that cannot be reached
  from the root are in none of them.

  \par Complexity
  Linear in the number of nodes.
*/
template <class Kernel>
std::vector<std::vector<std::size_t>> nodes_by_branch(const Tree_skeleton<Kernel>& tree)
{
  const Tree_bundle& bundle = tree[boost::graph_bundle];
  std::vector<std::vector<std::size_t>> nodes(bundle.branches.size());
  std::vector<std::size_t> stack;
  if (bundle.root != npos)
    stack.push_back(bundle.root);
  while (!stack.empty()) {
    const std::size_t v = stack.back();
    stack.pop_back();
    nodes[tree[v].branch].push_back(v);
    for (const auto e : boost::make_iterator_range(out_edges(v, tree)))
      stack.push_back(target(e, tree));
  }
  return nodes;
}

} // namespace pcs

#endif // PCS_CORE_TREE_SKELETON_H
