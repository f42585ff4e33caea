// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How a point lies beside the branch that explains it: its distance from the surface, and the direction from the axis.

#ifndef PCS_SKELETON_RESIDUAL_OF_POINT_H
#define PCS_SKELETON_RESIDUAL_OF_POINT_H

#include <pcs/skeleton/Axis.h>
#include <pcs/skeleton/Axis_set.h>
#include <pcs/skeleton/Branch_tree.h>
#include <pcs/skeleton/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// The vector from the axis of its branch to point `p`, which has a node. `axes` is empty if the tree was not made of axes.
inline Vec3
offset_of_point(const Scan& scan, const Axis_set& axes, const Branch_tree& tree, Index p)
{
  const Vec3& point = scan.points[p];
  if (!axes.axes.empty()) {
    const Axis& axis = axes.axes[axes.axis_of_point[p]].axis;
    return point - point_at(axis, nearest_place(axis, axes.segment_of_point[p], point));
  }
  const Branch_node& node = tree.nodes[tree.node_of_point[p]];
  const Vec3& base = node.parent == none ? node.point : tree.nodes[node.parent].point;
  const Vec3 along = node.point - base;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? (point - base).dot(along) / length2 : 0;
  return point - base - std::min(1.0, std::max(0.0, t)) * along;
}

/// Distance of point `p`, which has a node, from the surface of its branch; negative inside [L].
inline double
residual_of_point(const Scan& scan, const Axis_set& axes, const Branch_tree& tree, Index p)
{
  if (!axes.axes.empty())
    return axes.height_above(p, scan.points[p]);
  const Index v = tree.node_of_point[p];
  const Branch_node& node = tree.nodes[v];
  const Branch_node& below = tree.nodes[node.parent == none ? v : node.parent];
  const Vec3 d = node.point - below.point, q = scan.points[p] - below.point;
  const double t =
      d.squaredNorm() > 0 ? std::min(1.0, std::max(0.0, q.dot(d) / d.squaredNorm())) : 1;
  return (q - t * d).norm() - (1 - t) * below.radius - t * node.radius;
}

/// The median distance of the points from the surface, of some ten thousand spread over all [L].
inline double median_residual(const Scan& scan, const Axis_set& axes, const Branch_tree& tree)
{
  std::vector<double> distances;
  constexpr std::size_t enough = 20000;
  const std::size_t n = tree.node_of_point.size(), step = 1 + n / enough;
  for (std::size_t i = 0; i < n; i += step)
    if (tree.node_of_point[i] != none)
      distances.push_back(std::abs(residual_of_point(scan, axes, tree, static_cast<Index>(i))));
  return median(distances);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESIDUAL_OF_POINT_H
