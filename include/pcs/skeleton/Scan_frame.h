// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Coordinates that belong to a scan, however it was moved, turned about the vertical, scaled or shuffled.

#ifndef PCS_SKELETON_SCAN_FRAME_H
#define PCS_SKELETON_SCAN_FRAME_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  An origin in the middle of the points, the third axis upwards, the first to where most far points lie, a typical distance
  of points from the origin as unit. All work is done in these coordinates, rounded to a grid: copies of a scan then
  are the same scan bit by bit, and rounding decides nothing.
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
  Vec3 to_grid(const Vec3& p) const
  {
    constexpr double cells = 1 << 24; // per unit: far below the noise of scans, far above rounding
    const Vec3 q = cells * to_local(p);
    return Vec3(std::round(q.x()), std::round(q.y()), std::round(q.z())) / cells;
  }
};

/// Below this asymmetry of the points, the frame is not turned [-].
constexpr double least_asymmetry = 1e-6;

/// The frame of a scan. `input` is finite and not empty, `up` a unit vector. O(n).
inline Scan_frame frame_of_scan(const std::vector<Eigen::Vector3d>& input, const Eigen::Vector3d& up)
{
  using Vec3 = Eigen::Vector3d;
  Scan_frame frame;
  const Vec3 first = input.front();
  double extent = 0;
  for (const Vec3& p : input)
    extent = std::max(extent, (p - first).cwiseAbs().maxCoeff());
  frame.origin = first;
  // robust against points far away: weights fall with the distance, smoothly, so that rounding does not matter
  constexpr int rounds = 4;
  Vec3 center = Vec3::Zero();
  double reach = 0;
  const auto weight = [&](double squared_distance) {
    const double x = reach > 0 ? squared_distance / (reach * reach) : 0;
    return 1 / ((1 + x) * (1 + x));
  };
  std::vector<double> distance(input.size());
  const bool is_extended = extent > 0 && std::isfinite(extent);
  for (int round = 0; round < rounds && is_extended; ++round) {
    Vec3 sum = Vec3::Zero();
    double all = 0;
    for (const Vec3& p : input) {
      const Vec3 d = (p - first) / extent;
      const double w = weight((d - center).squaredNorm());
      sum += w * d;
      all += w;
    }
    center = sum / all;
    for (std::size_t i = 0; i < input.size(); ++i)
      distance[i] = ((input[i] - first) / extent - center).squaredNorm();
    const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
    std::nth_element(distance.begin(), middle, distance.end());
    reach = std::sqrt(*middle);
  }
  if (is_extended) {
    frame.origin = first + extent * center;
    frame.unit = reach > 0 ? extent * reach : extent;
  }
  Vec3 moment = Vec3::Zero();
  double all = 0;
  for (const Vec3& p : input) {
    if (!is_extended)
      break;
    const Vec3 d = (p - first) / extent - center;
    const Vec3 across = d - up.dot(d) * up;
    const double r2 = d.squaredNorm(), w = weight(r2) * r2;
    moment += w * across;
    all += w * across.norm();
  }
  const bool is_turned = moment.norm() > least_asymmetry * all;
  const Vec3 x = Vec3::UnitX() - up.x() * up;
  const Vec3 side = is_turned ? moment : x.norm() > 0.1 ? x : Vec3(up.unitOrthogonal());
  const Vec3 e1 = (side - up.dot(side) * up).normalized();
  frame.axes.row(0) = e1.transpose();
  frame.axes.row(1) = up.cross(e1).transpose();
  frame.axes.row(2) = up.transpose();
  return frame;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_FRAME_H
