// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Groups the nodes of a tree into branches by their radii.

#ifndef PCS_CORE_ASSIGN_BRANCHES_H
#define PCS_CORE_ASSIGN_BRANCHES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>

#include <CGAL/number_utils.h>

#include <boost/graph/graph_traits.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace internal {

//! returns the length of the longest path from each node to a tip; throws unless all nodes descend
//! from the root
template <class Kernel>
std::vector<double> lengths_to_tips(const Tree_skeleton<Kernel>& tree)
{
  const std::size_t root = tree[boost::graph_bundle].root;
  const std::size_t n = num_vertices(tree);
  if (n == 0)
    return {};
  if (root >= n || in_degree(root, tree) != 0)
    throw Invalid_input("pcs::assign_branches(): the root must be a node without parent");
  std::vector<std::size_t> order = {root};
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const auto e : boost::make_iterator_range(out_edges(order[i], tree))) {
      if (in_degree(target(e, tree), tree) != 1)
        throw Invalid_input("pcs::assign_branches(): node " + std::to_string(target(e, tree)) +
                            " has more than one parent");
      order.push_back(target(e, tree));
    }
  if (order.size() != n)
    throw Invalid_input("pcs::assign_branches(): " + std::to_string(n - order.size()) +
                        " nodes cannot be reached from the root");
  std::vector<double> length(n, 0);
  for (std::size_t i = n; i-- > 1;) {
    const std::size_t v = order[i], p = parent_node<Kernel>(v, tree);
    const auto &a = tree[p].point, &b = tree[v].point;
    const double through = length[v] + std::hypot(CGAL::to_double(b.x() - a.x()),
                                                  CGAL::to_double(b.y() - a.y()),
                                                  CGAL::to_double(b.z() - a.z()));
    if (through > length[p])
      length[p] = through;
  }
  return length;
}

//! assigns branches like the public `assign_branches()`; `child(v)` is the node that continues the
//! branch of node `v`, or `npos`
template <class Kernel, class Child>
void assign_branches(Tree_skeleton<Kernel>& tree, const Child& child)
{
  std::vector<Tree_branch>& branches = tree[boost::graph_bundle].branches;
  branches.clear();
  if (num_vertices(tree) == 0)
    return;
  struct Base
  {
    std::size_t node, parent_branch;
  };
  std::vector<Base> bases = {{tree[boost::graph_bundle].root, npos}};
  for (std::size_t next = 0; next < bases.size(); ++next) {
    const auto [base, parent] = bases[next];
    const std::size_t branch = branches.size();
    branches.push_back({parent, parent == npos ? 0 : branches[parent].order + 1, branch});
    for (std::size_t v = base; v != npos;) {
      tree[v].branch = branch;
      const std::size_t main = child(v);
      for (const auto e : boost::make_iterator_range(out_edges(v, tree)))
        if (target(e, tree) != main)
          bases.push_back({target(e, tree), branch});
      v = main;
    }
  }
}

} // namespace internal

/*!
  \ingroup PkgPcsCoreRef
  \brief groups the nodes of a tree into branches if its source defines none.

  At every fork the thickest child continues the branch of its parent. Among equally thick children
  it is the one with the longest path to a tip, then the one with the lowest number. The other
  children begin new branches. Branches are numbered breadth-first from the trunk; their `id` is
  their number.

  \tparam Kernel a kernel of CGAL
  \param tree its `branches`, and `branch` of all nodes, are overwritten
  \throws pcs::Invalid_input unless the graph is a tree below its root; it is unchanged then
  \par Complexity
  Linear in the number of nodes.
*/
template <class Kernel>
void assign_branches(Tree_skeleton<Kernel>& tree)
{
  const std::vector<double> length = internal::lengths_to_tips<Kernel>(tree);
  internal::assign_branches<Kernel>(tree, [&](std::size_t v) {
    std::size_t main = npos;
    for (const auto e : boost::make_iterator_range(out_edges(v, tree))) {
      const std::size_t w = target(e, tree);
      if (main == npos || tree[w].radius > tree[main].radius ||
          (tree[w].radius == tree[main].radius &&
           (length[w] > length[main] || (length[w] == length[main] && w < main))))
        main = w;
    }
    return main;
  });
}

} // namespace pcs

#endif // PCS_CORE_ASSIGN_BRANCHES_H
