// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Residual of a point: distance from the surface of its branch, and direction from the axis.

#ifndef PCS_SKELETON_RESULT_RESIDUAL_OF_POINT_H
#define PCS_SKELETON_RESULT_RESIDUAL_OF_POINT_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/nearest_edge.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Returns the vector from the axis to a point on the branch at node `v`. `next` is the result of
/// `successors()`.
inline Vec3
offset_of_point(const Branch_tree& tree, const std::vector<Index>& next, Index v, const Vec3& point)
{
  return nearest_edge(tree, next, v, point, Base_edge::cylinder).offset;
}

/// Returns the signed distance of a point from the surface of the branch at node `v`, negative
/// inside [L]. The surface consists of truncated cones between nodes.
inline double residual_of_point(const Branch_tree& tree,
                                const std::vector<Index>& next,
                                Index v,
                                const Vec3& point)
{
  const Place_on_edge place = nearest_edge(tree, next, v, point, Base_edge::cylinder);
  return std::sqrt(place.squared_distance) - place.radius;
}

/// Returns the median distance of the points from the surface, from an even sample of some ten
/// thousand [L].
inline double
median_residual(const Scan& scan, const Branch_tree& tree, const std::vector<Index>& next)
{
  std::vector<double> distances;
  constexpr std::size_t enough = 20000;
  const std::size_t n = tree.node_of_point.size(), step = 1 + n / enough;
  for (std::size_t i = 0; i < n; i += step)
    if (tree.node_of_point[i] != none)
      distances.push_back(
          std::abs(residual_of_point(tree, next, tree.node_of_point[i], scan.points[i])));
  return pcs::internal::lower_median(distances);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESULT_RESIDUAL_OF_POINT_H
