// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Canonical frame of a scan, independent of position, yaw, scale and order of the points.

#ifndef PCS_SKELETON_MODEL_SCAN_FRAME_H
#define PCS_SKELETON_MODEL_SCAN_FRAME_H

#include <Eigen/Core>

#include <cmath>

namespace pcs {
namespace skeleton {

/*!
  Local frame. The origin is a robust mean of the points. The third axis points upwards. The first
  axis points horizontally towards a mean of the points that is weighted by their distances. The
  unit is a typical distance of points from the origin. All computations use these coordinates,
  rounded to a grid: copies of a scan that were moved, scaled or rotated about the vertical then
  have the same coordinates, except within rounding errors of a cell border.
*/
struct Scan_frame
{
  using Vec3 = Eigen::Vector3d;

  Vec3 origin = Vec3::Zero();                         ///< in input coordinates
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity(); ///< by rows, in input coordinates
  double unit = 1;                                    ///< [L]

  Vec3 to_local(const Vec3& p) const { return axes * (p - origin) / unit; }
  Vec3 to_input(const Vec3& p) const { return unit * (axes.transpose() * p) + origin; }
  Vec3 direction_to_local(const Vec3& d) const { return axes * d; }
  Vec3 direction_to_input(const Vec3& d) const { return axes.transpose() * d; }

  /// Returns local coordinates, rounded to the grid.
  Vec3 to_grid(const Vec3& p) const { return rounded(to_local(p)); }
  /// Rounds local coordinates to the grid.
  static Vec3 rounded(const Vec3& local)
  {
    constexpr double cells = 1 << 24; // per unit: far below the noise of scans, far above rounding
    const Vec3 q = cells * local;
    return Vec3(std::round(q.x()), std::round(q.y()), std::round(q.z())) / cells;
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_SCAN_FRAME_H
