// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree of the space as a skeleton of the caller.

#ifndef PCS_SHAPE_SPACE_WRITE_SKELETON_H
#define PCS_SHAPE_SPACE_WRITE_SKELETON_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/shape_space/Orl_coordinates.h>

#include <boost/graph/adjacency_list.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// A tree of the space as a skeleton. Branches without length, and what hangs on them, are left out.
template <class Kernel>
void write_skeleton(const Orl_layout& layout,
                    const Orl_coordinates& x,
                    const Orl_geometry& geometry,
                    const Vec3& origin,
                    Tree_skeleton<Kernel>& result)
{
  using FT = typename Kernel::FT;
  Tree_skeleton<Kernel> tree;
  Tree_bundle& bundle = tree[boost::graph_bundle];
  std::vector<std::size_t> vertex(layout.number_of_nodes(), npos);
  std::vector<std::size_t> branch_of(layout.branches.size(), npos);
  const std::vector<std::size_t> order = orders_of_branches(layout, x);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    if (order[b] == none)
      continue;
    const bool is_trunk = branch.parent == none;
    branch_of[b] = bundle.branches.size();
    bundle.branches.push_back(
        {is_trunk ? npos : branch_of[branch.parent], static_cast<int>(order[b]), b});
    std::size_t previous = npos;
    if (!is_trunk) {
      const auto last = static_cast<double>(layout.branches[branch.parent].number_of_edges);
      const double t = std::min(last, std::max(0.0, x.attachment[b]));
      previous = vertex[layout.first_node(branch.parent) + static_cast<std::size_t>(t)];
    }
    for (std::size_t j = 0; j <= branch.number_of_edges; ++j) {
      const std::size_t v = layout.first_node(b) + j;
      const Vec3 p = geometry.node[v] + origin;
      Tree_node<Kernel> node;
      node.point = typename Kernel::Point_3(static_cast<FT>(p.x()),
                                            static_cast<FT>(p.y()),
                                            static_cast<FT>(p.z()));
      node.radius = node.major_radius = node.minor_radius = static_cast<FT>(geometry.radius[v]);
      node.branch = branch_of[b];
      vertex[v] = add_vertex(node, tree);
      if (previous != npos)
        add_edge(previous, vertex[v], tree);
      else
        bundle.root = vertex[v];
      previous = vertex[v];
    }
  }
  result = std::move(tree);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_WRITE_SKELETON_H
