// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Circle fit by Taubin's method, and the arc that the points cover.

#ifndef PCS_SKELETON_MODEL_CIRCLE_FIT_H
#define PCS_SKELETON_MODEL_CIRCLE_FIT_H

#include <pcs/internal/constants.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

using Vec2 = Eigen::Vector2d;

struct Circle
{
  Vec2 center = Vec2::Zero();
  double radius = 0;    ///< 0: no circle
  double deviation = 0; ///< root mean square distance of the points from it [L]
};

/// Fits a circle by Taubin's method (Newton's method on its characteristic polynomial), which is
/// unbiased on short arcs. At least 3 points.
inline Circle fit_circle(const std::vector<Vec2>& points)
{
  Circle circle;
  const double n = double(points.size());
  if (points.size() < 3)
    return circle;
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points)
    mean += p;
  mean /= n;
  double xx = 0, yy = 0, xy = 0, xz = 0, yz = 0, zz = 0;
  for (const Vec2& p : points) {
    const double x = p.x() - mean.x(), y = p.y() - mean.y(), z = x * x + y * y;
    xx += x * x;
    yy += y * y;
    xy += x * y;
    xz += x * z;
    yz += y * z;
    zz += z * z;
  }
  xx /= n, yy /= n, xy /= n, xz /= n, yz /= n, zz /= n;
  const double z = xx + yy, cov = xx * yy - xy * xy;
  if (!(z > 0) || !(cov > 1e-12 * z * z))
    return circle; // on a line
  const double var = zz - z * z;
  const double a3 = 4 * z, a2 = -3 * z * z - zz, a1 = var * z + 4 * cov * z - xz * xz - yz * yz;
  const double a0 = xz * (xz * yy - yz * xy) + yz * (yz * xx - xz * xy) - var * cov;
  double x = 0, y = a0;
  for (int i = 0; i < 50; ++i) {
    const double slope = a1 + x * (2 * a2 + x * 3 * a3);
    const double next = x - y / slope;
    if (!std::isfinite(next) || next == x)
      break;
    const double value = a0 + next * (a1 + next * (a2 + next * a3));
    if (std::abs(value) >= std::abs(y))
      break;
    x = next;
    y = value;
  }
  const double det = x * x - x * z + cov;
  if (!(std::abs(det) > 1e-14 * z * z))
    return circle;
  const Vec2 c((xz * (yy - x) - yz * xy) / (2 * det), (yz * (xx - x) - xz * xy) / (2 * det));
  circle.center = c + mean;
  circle.radius = std::sqrt(c.squaredNorm() + z);
  double sum = 0;
  for (const Vec2& p : points) {
    const double e = (p - circle.center).norm() - circle.radius;
    sum += e * e;
  }
  circle.deviation = std::sqrt(sum / n);
  return circle;
}

/// Number of sectors of a full turn for measuring arcs [count].
constexpr int number_of_sectors = 12;

/// Counts the sectors around `center` that contain a point. The sectors are aligned with the mean
/// of the points, so that the count does not depend on the frame of the plane.
inline int covered_sectors(const std::vector<Vec2>& points, const Vec2& center)
{
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points)
    mean += p - center;
  unsigned seen = 0;
  for (const Vec2& p : points) {
    const Vec2 d = p - center;
    const double angle =
        std::atan2(mean.x() * d.y() - mean.y() * d.x(), mean.x() * d.x() + mean.y() * d.y());
    const double turn = angle / (2 * pcs::internal::pi) + 0.5;
    const int sector = static_cast<int>(turn * number_of_sectors) % number_of_sectors;
    seen |= 1u << sector;
  }
  int count = 0;
  for (int s = 0; s < number_of_sectors; ++s)
    count += (seen >> s) & 1u;
  return count;
}

/// Returns the expected number of sectors that contain one of `count` random points.
inline double sectors_of_random_points(std::size_t count)
{
  return number_of_sectors * (1 - std::pow(1 - 1.0 / number_of_sectors, double(count)));
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_CIRCLE_FIT_H
