// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nearest position on the edges at the node of a point.

#ifndef PCS_SKELETON_MODEL_NEAREST_EDGE_H
#define PCS_SKELETON_MODEL_NEAREST_EDGE_H

#include <pcs/skeleton/model/Branch_tree.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Returns the next node of the same branch for each node; `none` at tips.
inline std::vector<Index> successors(const Branch_tree& tree)
{
  std::vector<Index> next(tree.nodes.size(), none);
  for (const Branch& b : tree.branches)
    for (std::size_t k = 0; k + 1 < b.nodes.size(); ++k)
      next[b.nodes[k]] = b.nodes[k + 1];
  return next;
}

/// Projection of a point onto an edge.
struct Place_on_edge
{
  double squared_distance = std::numeric_limits<double>::infinity();
  Vec3 offset = Vec3::Zero(); ///< from the axis to the point [L]
  double radius = 0;          ///< of the branch at the projection [L]
};

enum class Base_edge {
  left_out,
  cylinder ///< with the radius of the branch, as in the surface mesh
};

/// Projects `point` onto the nearest of three edges: the edge before node `v` and the two after it
/// on its branch. `next`: `successors()` of the tree.
inline Place_on_edge nearest_edge(const Branch_tree& tree,
                                  const std::vector<Index>& next,
                                  Index v,
                                  const Vec3& point,
                                  Base_edge base)
{
  Place_on_edge best;
  const auto offer = [&](Index a, Index b, bool is_cylinder) {
    if (a == none || b == none)
      return;
    const Branch_node &from = tree.nodes[a], &to = tree.nodes[b];
    const Vec3 along = to.point - from.point, q = point - from.point;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::min(1.0, std::max(0.0, q.dot(along) / length2)) : 0;
    const Vec3 offset = q - t * along;
    const double d = offset.squaredNorm();
    if (d < best.squared_distance)
      best = {d, offset, is_cylinder ? to.radius : (1 - t) * from.radius + t * to.radius};
  };
  if (!tree.is_base(v))
    offer(tree.nodes[v].parent, v, false);
  else if (base == Base_edge::cylinder)
    offer(tree.nodes[v].parent == none ? v : tree.nodes[v].parent, v, true);
  offer(v, next[v], false);
  offer(next[v], next[v] == none ? none : next[next[v]], false);
  return best;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_NEAREST_EDGE_H
