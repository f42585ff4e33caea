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

/// Criteria for points on a voxel grid, and the widening of radii by the voxels.
struct Voxel_size_options
{
  double share = 0.8;         ///< least fraction of points with their nearest one a step away [-]
  double tolerance = 0.01;    ///< tolerance of the lengths [-] and directions [rad] of these steps
  std::size_t fewest = 100;   ///< least number of points for a detection [count]
  std::size_t enough = 20000; ///< points of an even sample [count]
  double widening = 0.3;      ///< increase of a squared radius, in squared steps [-]
  double least = 0.6;         ///< least corrected radius, as a fraction of the fitted one [-]
};

/*!
  Returns the step of the grid on which the points lie, such as the centres of voxels, or 0 if there
  is none [L]. On a grid, the nearest point is nearly always one step away, along one of three
  directions. The grid may be rotated. O(1), from some ten thousand points.
*/
inline double voxel_size(const Scan& scan, const Voxel_size_options& rules)
{
  const std::size_t n = scan.size(), stride = 1 + n / rules.enough;
  const double step = scan.spacing;
  if (n < rules.fewest || !(step > 0))
    return 0;
  std::vector<Vec3> directions; // to neighbours one step away
  for (std::size_t i = 0; i < n; i += stride) {
    const Vec3 d = scan.points[scan.neighbors[i][0]] - scan.points[i];
    if (std::abs(d.norm() - step) <= rules.tolerance * step)
      directions.push_back(d.normalized());
  }
  const double wanted = rules.share * double((n + stride - 1) / stride);
  if (double(directions.size()) < wanted)
    return 0;
  // two perpendicular directions define the three axes
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
  Corrects the radii for the voxel size. The centres of the voxels that a branch touches lie, on
  average, outside its surface: voxels of size h touch the surface from both sides, and the volume
  outside is larger. The fit returns approximately sqrt(r^2 + 0.3 h^2) (simulated: the mean distance
  is sqrt(r^2 + (0.22 to 0.39) h^2) for r up to 3 h). The function inverts this relation. O(nodes).
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
