// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Canonical frame of a tree, for results independent of its pose.

#ifndef PCS_SHAPE_SPACE_MATCHING_CANONICAL_FRAME_H
#define PCS_SHAPE_SPACE_MATCHING_CANONICAL_FRAME_H

#include <pcs/shape_space/model/Rooted_tree.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>

namespace pcs {
namespace shape_space {

/// Returns a frame with columns as axes: z from the root to the tip of the longest path, x to the
/// heavier side. If the sides weigh the same, x points to the node that is farthest from the z
/// axis.
inline Eigen::Matrix3d canonical_frame(const Rooted_tree& tree)
{
  constexpr double least = 1e-6; // of the extent: less is rounding
  std::size_t tip = 0;
  while (tree.first_child[tip] < tree.first_child[tip + 1])
    tip = tree.children[tree.first_child[tip]];
  Vec3 z = tree.points[tip] - tree.points[0], side = Vec3::Zero(), farthest = Vec3::Zero();
  if (!(z.norm() > least * tree.extent)) // the trunk returns to the root
    z = tree.points[tree.children[tree.first_child[0]]] - tree.points[0];
  z.normalize();
  double total = 0;
  // scaled, so that fourth powers stay in range in any unit; scaling by a power of 2 is exact
  const int unit = tree.extent > 0 ? std::ilogb(tree.extent) : 0;
  for (std::size_t v = 1; v < tree.size(); ++v) {
    const double length = std::ldexp(tree.edge_length(v), -unit);
    const Vec3 p = tree.points[v] - tree.points[0];
    const Vec3 off = p - p.dot(z) * z;
    total += length;
    side += length * off;
    if (off.norm() > farthest.norm() * (1 + 1e-9))
      farthest = off;
  }
  if (side.norm() > least * total * tree.extent)
    side.normalize();
  else if (farthest.norm() > least * tree.extent)
    side = farthest.normalized();
  else
    side = z.unitOrthogonal();
  side = (side - side.dot(z) * z).normalized();
  Eigen::Matrix3d frame;
  frame << side, z.cross(side), z;
  return frame;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_CANONICAL_FRAME_H
