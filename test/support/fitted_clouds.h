// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pairs of clouds of one bent body, with true correspondences.

#ifndef PCS_TEST_SUPPORT_FITTED_CLOUDS_H
#define PCS_TEST_SUPPORT_FITTED_CLOUDS_H

#include <support/point_clouds.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs_test {

/// Returns `n` points on a long body with six arms of different lengths, which no rotation maps to
/// itself. Its extent is about 10. Other values of `turn` give other samplings of the same surface.
inline Points star(std::size_t n, double turn)
{
  struct Arm
  {
    Vec3 direction;
    double length;
  };
  const Arm arms[] = {{Vec3(0, 0, 1), 0.9},
                      {Vec3(0.1, 0.2, -1).normalized(), 0.7},
                      {Vec3(1, 0.2, 0.3).normalized(), 0.8},
                      {Vec3(-0.9, 0.4, 0.2).normalized(), 0.6},
                      {Vec3(0.2, -1, -0.3).normalized(), 0.5},
                      {Vec3(-0.1, 0.9, -0.5).normalized(), 0.7}};
  Points points;
  const double golden = 3.883222077450933; // angle of a spiral without rows [rad]
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(n);
    const double r = std::sqrt(1 - z * z), a = golden * double(i) + turn;
    const Vec3 s(r * std::cos(a), r * std::sin(a), z);
    double scale = 0.7;
    for (const Arm& arm : arms)
      scale += arm.length * std::exp(-7 * (s - arm.direction).squaredNorm());
    points.push_back(scale * Vec3(s.x(), s.y(), 3 * s.z()));
  }
  return points;
}

/// Bends about the y axis by `curvature` [rad per length along z].
inline Vec3 bend(const Vec3& p, double curvature)
{
  if (curvature == 0)
    return p;
  const double r = 1 / curvature - p.x(), a = curvature * p.z();
  return Vec3(1 / curvature - r * std::cos(a), p.y(), r * std::sin(a));
}

inline Points bend(Points points, double curvature)
{
  for (Vec3& p : points)
    p = bend(p, curvature);
  return points;
}

inline double rms_distance(const Points& a, const Points& b)
{
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / double(a.size()));
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_FITTED_CLOUDS_H
