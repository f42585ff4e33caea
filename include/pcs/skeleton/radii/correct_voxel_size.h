// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of voxel-thinned scans, and correction of radii for the voxel size.

#ifndef PCS_SKELETON_RADII_CORRECT_VOXEL_SIZE_H
#define PCS_SKELETON_RADII_CORRECT_VOXEL_SIZE_H

#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// When points lie on a grid, and what that adds to radii.
struct Voxel_size_options
{
  double share = 0.8;         ///< of the points whose nearest one is a step away along an axis [-]
  double tolerance = 0.01;    ///< of the lengths [-] and directions [rad] of these steps
  std::size_t fewest = 100;   ///< points that can tell [count]
  std::size_t enough = 20000; ///< points that are looked at, spread over all [count]
  double widening = 0.3;      ///< of the square of a radius, in squares of the step [-]
  double least = 0.6;         ///< share of a radius that is left at least [-]
};

/*!
  The step of a grid whose nodes the points are, as the centers of voxels are; 0: they are on none
  [L]. There the nearest point is one step away nearly always, along one of three directions. The
  grid may be turned. O(1), from some ten thousand points.
*/
inline double voxel_size(const Scan& scan, const Voxel_size_options& rules)
{
  const std::size_t n = scan.size(), stride = 1 + n / rules.enough;
  const double step = scan.spacing;
  if (n < rules.fewest || !(step > 0))
    return 0;
  std::vector<Vec3> directions; // of those that are one step away
  for (std::size_t i = 0; i < n; i += stride) {
    const Vec3 d = scan.points[scan.neighbors[i][0]] - scan.points[i];
    if (std::abs(d.norm() - step) <= rules.tolerance * step)
      directions.push_back(d.normalized());
  }
  const double wanted = rules.share * double((n + stride - 1) / stride);
  if (double(directions.size()) < wanted)
    return 0;
  // three axes by two directions that are perpendicular to each other
  const Vec3 first = directions[directions.size() / 2];
  const auto second = std::find_if(directions.begin(), directions.end(), [&](const Vec3& d) {
    return std::abs(d.dot(first)) <= rules.tolerance;
  });
  if (second == directions.end())
    return 0;
  const Vec3 third = first.cross(*second);
  const auto on_axes = std::count_if(directions.begin(), directions.end(), [&](const Vec3& d) {
    const double cosine =
        std::max({std::abs(d.dot(first)), std::abs(d.dot(*second)), std::abs(d.dot(third))});
    return cosine >= std::cos(rules.tolerance);
  });
  return double(on_axes) >= wanted ? step : 0;
}

/*!
  The centers of the voxels that a branch touches lie farther from its axis than its surface on the
  average: a cube of size h reaches the surface from outside as from inside, and there is more room
  outside. The fit finds sqrt(r^2 + 0.3 h^2), nearly (simulated: the mean distance is sqrt(r^2 +
  (0.22 to 0.39) h^2) for r up to 3 h). Inverts this. O(nodes).
*/
inline void correct_voxel_size(double step, const Voxel_size_options& rules, Branch_tree& tree)
{
  if (!(step > 0))
    return;
  for (Branch_node& node : tree.nodes) {
    const double found = node.radius;
    node.resize(std::max(rules.least * found,
                         std::sqrt(std::max(0.0, found * found - rules.widening * step * step))));
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_CORRECT_VOXEL_SIZE_H
