// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Planar patches away from thick wood: single leaves that are well resolved.

#ifndef PCS_SKELETON_LEAVES_DETECT_PLANAR_PATCHES_H
#define PCS_SKELETON_LEAVES_DETECT_PLANAR_PATCHES_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for planar patches.
struct Planar_patch_options
{
  double link = 2;         ///< largest distance of connected neighbours, in spacings [-]
  std::size_t fewest = 6;  ///< points of a patch [count]
  double thickness = 0.32; ///< largest thickness, relative to the width [-]
  double width = 0.32;     ///< least width, relative to the length [-]
};

/*!
  Counts the points of `is_open` in planar patches: connected components that are flat and wide.
  Components connected to thick wood are ignored, since its surface is also flat. O(points).
*/
inline std::size_t count_patch_points(const Scan& scan,
                                      const std::vector<std::uint8_t>& is_open,
                                      const std::vector<std::uint8_t>& is_thick,
                                      const Planar_patch_options& rules)
{
  struct Group
  {
    std::size_t count = 0;
    Vec3 sum = Vec3::Zero();
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< relative to the first point, like `sum`
    bool is_on_wood = false;
  };
  const std::size_t n = scan.size();
  const double reach = rules.link * scan.spacing;
  Point_sets sets(n);
  std::vector<std::uint8_t> is_on_wood(n, 0);
  for (Index i = 0; i < n; ++i)
    for (const Index j : scan.neighbors[i]) {
      if (!is_open[i] || j == none || (scan.points[j] - scan.points[i]).norm() > reach)
        break; // the nearest come first
      is_on_wood[i] |= is_thick[j];
      if (is_open[j])
        sets.unite(i, j);
    }
  std::vector<Group> groups(n);
  for (Index i = 0; i < n; ++i) {
    if (!is_open[i])
      continue;
    const Index first = sets.find(i);
    Group& group = groups[first];
    const Vec3 d = scan.points[i] - scan.points[first];
    ++group.count;
    group.sum += d;
    group.moment += d * d.transpose();
    group.is_on_wood |= is_on_wood[i] != 0;
  }
  std::size_t count = 0;
  for (const Group& group : groups) {
    if (group.count < rules.fewest || group.is_on_wood)
      continue;
    const Eigen::Matrix3d covariance =
        group.moment - group.sum * group.sum.transpose() / double(group.count);
    const Vec3 square = linear_algebra::symmetric_eigen<3>(covariance).values; // lowest first
    if (square(0) < rules.thickness * rules.thickness * square(1) &&
        square(1) > rules.width * rules.width * square(2))
      count += group.count;
  }
  return count;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_DETECT_PLANAR_PATCHES_H
