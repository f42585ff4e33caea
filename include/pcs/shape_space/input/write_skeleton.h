// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a tree of the space to a skeleton of the caller.

#ifndef PCS_SHAPE_SPACE_INPUT_WRITE_SKELETON_H
#define PCS_SHAPE_SPACE_INPUT_WRITE_SKELETON_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <boost/graph/adjacency_list.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Returns, for each branch, the positions at which its children begin, without duplicates: number
/// of a node plus the fraction of the next edge. Positions near a node are moved to it.
/// `attachment`: position of each branch on its parent.
inline std::vector<std::vector<double>>
attachments_of_children(const Orl_layout& layout,
                        const Orl_coordinates& x,
                        const std::vector<std::size_t>& order,
                        std::vector<double>& attachment)
{
  constexpr double at_node = 1e-9;
  std::vector<std::vector<double>> attachments(layout.branches.size());
  attachment.assign(layout.branches.size(), 0);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const std::size_t parent = layout.branches[b].parent;
    if (parent == none || order[b] == none)
      continue;
    const auto last = static_cast<double>(layout.branches[parent].number_of_edges);
    attachment[b] = std::min(last, std::max(0.0, x.attachment[b]));
    if (std::abs(attachment[b] - std::round(attachment[b])) < at_node)
      attachment[b] = std::round(attachment[b]);
    attachments[parent].push_back(attachment[b]);
  }
  for (auto& of_parent : attachments) {
    std::sort(of_parent.begin(), of_parent.end());
    of_parent.erase(std::unique(of_parent.begin(), of_parent.end()), of_parent.end());
  }
  return attachments;
}

/// Returns the largest distance of two nodes that are in one place, as for trees that are read. [L]
inline double least_length(const Orl_geometry& geometry)
{
  Vec3 low = geometry.node[0], high = low;
  for (const Vec3& p : geometry.node) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return shortest_edge * (high - low).norm();
}

} // namespace internal

/*!
  Writes a tree of the space as a skeleton. An edge that supports a branch is divided there.

  A branch that is not longer than `least_length`, and its subtree, are left out: the tree lacks
  them. A node that is not farther than `least_length` from the previous node of its branch is
  joined with it. Only the first node of a branch, which has its base radius, is in the place of a
  node of the parent. With a negative `least_length`, all branches and nodes are written. [L]
*/
template <class Kernel>
void write_skeleton(const Orl_layout& layout,
                    const Orl_coordinates& x,
                    const Orl_geometry& geometry,
                    const Vec3& origin,
                    double least_length,
                    Tree_skeleton<Kernel>& result)
{
  using FT = typename Kernel::FT;
  Tree_skeleton<Kernel> tree;
  Tree_bundle& bundle = tree[boost::graph_bundle];
  std::vector<std::size_t> branch_of(layout.branches.size(), npos);
  const std::vector<std::size_t> order = orders_of_branches(layout, x, least_length);
  std::vector<double> attachment;
  const std::vector<std::vector<double>> attachments =
      internal::attachments_of_children(layout, x, order, attachment);
  std::vector<std::vector<std::size_t>> vertex_at(layout.branches.size());
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    if (order[b] == none)
      continue;
    const bool is_trunk = branch.parent == none;
    branch_of[b] = bundle.branches.size();
    bundle.branches.push_back(
        {is_trunk ? npos : branch_of[branch.parent], static_cast<int>(order[b]), b});
    std::size_t previous = npos;
    Vec3 place = Vec3::Zero(); // of the previous node
    bool is_first = true;
    if (!is_trunk) {
      const auto& of_parent = attachments[branch.parent];
      const auto k = std::lower_bound(of_parent.begin(), of_parent.end(), attachment[b]);
      previous = vertex_at[branch.parent][static_cast<std::size_t>(k - of_parent.begin())];
    }
    const auto add = [&](const Vec3& local, double radius) {
      if (!is_first && (local - place).norm() <= least_length)
        return;
      is_first = false;
      place = local;
      const Vec3 p = local + origin;
      Tree_node<Kernel> node;
      node.point = typename Kernel::Point_3(static_cast<FT>(p.x()),
                                            static_cast<FT>(p.y()),
                                            static_cast<FT>(p.z()));
      node.radius = node.major_radius = node.minor_radius = static_cast<FT>(radius);
      node.branch = branch_of[b];
      const std::size_t v = add_vertex(node, tree);
      if (previous != npos)
        add_edge(previous, v, tree);
      else
        bundle.root = v;
      previous = v;
    };
    auto next = attachments[b].begin();
    for (std::size_t j = 0; j <= branch.number_of_edges; ++j) {
      const std::size_t v = layout.first_node(b) + j;
      const auto position = static_cast<double>(j);
      // between the previous node and this one
      for (; next != attachments[b].end() && *next < position; ++next) {
        const double f = *next - (position - 1);
        add((1 - f) * geometry.node[v - 1] + f * geometry.node[v],
            (1 - f) * geometry.radius[v - 1] + f * geometry.radius[v]);
        vertex_at[b].push_back(previous);
      }
      add(geometry.node[v], geometry.radius[v]);
      for (; next != attachments[b].end() && *next == position; ++next)
        vertex_at[b].push_back(previous);
    }
  }
  result = std::move(tree);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_WRITE_SKELETON_H
