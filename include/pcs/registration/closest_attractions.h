// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Attractions of source points by their closest matches, with robust weights.

#ifndef PCS_REGISTRATION_CLOSEST_ATTRACTIONS_H
#define PCS_REGISTRATION_CLOSEST_ATTRACTIONS_H

#include <pcs/internal/median.h>
#include <pcs/registration/Gauss_newton.h>
#include <pcs/registration/closest_matches.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace registration {

/// Share of the distance between points in the distance of a match; the rest is the distance from
/// the tangent plane. [-]
constexpr double point_share = 0.03;

/// Returns the scale of the distances of good matches: 2.5 medians, with a lower bound. [L]
inline double robust_scale(const std::vector<Closest_match>& matches, double lowest)
{
  std::vector<double> distances;
  for (const Closest_match& m : matches)
    if (m.weight > 0)
      distances.push_back(std::abs(m.plane_distance));
  return std::max(2.5 * pcs::internal::lower_median(distances), lowest);
}

/*!
  Adds the attraction of the source point `x` by the target point `y` with the normal `n`, the
  quadratic form of `w ((n (x - y))^2 + point_share |x - y|^2)`. The weight `w` contains that of
  Geman and McClure, `1 / (1 + (d / scale)^2)^2`.
*/
inline void add_match(const Vec3& x,
                      const Vec3& y,
                      const Vec3& n,
                      const Closest_match& match,
                      double weight,
                      double scale,
                      Attraction& attraction)
{
  const double u = match.plane_distance / scale;
  const double w = weight * match.weight / ((1 + u * u) * (1 + u * u));
  const bool has_plane = n.squaredNorm() > 0;
  Eigen::Matrix3d a = (has_plane ? point_share * w : w) * Eigen::Matrix3d::Identity();
  if (has_plane)
    a += w * n * n.transpose();
  attraction.a += a;
  attraction.pull += a * (y - x);
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_CLOSEST_ATTRACTIONS_H
