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
  An origin in the middle of the points, the third axis upwards, the first to where most far points
  lie, a typical distance of points from the origin as unit. All work is done in these coordinates,
  rounded to a grid: copies of a scan then are the same scan bit by bit, and rounding decides
  nothing.
*/
struct Scan_frame
{
  using Vec3 = Eigen::Vector3d;

  Vec3 origin = Vec3::Zero();                         ///< in input coordinates
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity(); ///< by rows, in input coordinates
  double unit = 1;                                    ///< [L]

  Vec3 to_local(const Vec3& p) const { return axes * (p - origin) / unit; }
  Vec3 to_input(const Vec3& p) const { return unit * (axes.transpose() * p) + origin; }
  Vec3 direction_to_input(const Vec3& d) const { return axes.transpose() * d; }

  /// The local coordinates on the grid.
  Vec3 to_grid(const Vec3& p) const { return rounded(to_local(p)); }
  /// Local coordinates, on the grid.
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
