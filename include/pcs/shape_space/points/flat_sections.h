// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Edges with flat cross-sections: blades of leaves.

#ifndef PCS_SHAPE_SPACE_POINTS_FLAT_SECTIONS_H
#define PCS_SHAPE_SPACE_POINTS_FLAT_SECTIONS_H

#include <pcs/shape_space/points/tube_coordinates.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// The cross-section of the points of an edge.
struct Section
{
  Eigen::Vector2d center = Eigen::Vector2d::Zero(), axis = Eigen::Vector2d::UnitX();
  double wide = 0, thin = 0; ///< standard deviations along `axis` and across it [L]

  /// Returns whether the section is flat. A half circle, the part of a stem visible from one
  /// station, is 2.3 times as wide as thin.
  bool is_flat() const { return wide > 2.5 * thin; }
};

/// Computes the section across an edge; a default section, which is not flat, if there are too few
/// points.
inline Section section_across(const Edge_cone& edge, const std::vector<Vec3>& points)
{
  constexpr std::size_t least_number = 20;
  Section result;
  if (points.size() < least_number)
    return result;
  const Eigen::Matrix3d to_local = edge.frame.transpose();
  const double n = static_cast<double>(points.size());
  for (const Vec3& p : points)
    result.center += (to_local * (p - edge.from)).head<2>() / n;
  double xx = 0, xy = 0, yy = 0;
  for (const Vec3& p : points) {
    const Eigen::Vector2d d = (to_local * (p - edge.from)).head<2>() - result.center;
    xx += d.x() * d.x() / n;
    xy += d.x() * d.y() / n;
    yy += d.y() * d.y() / n;
  }
  const double mean = 0.5 * (xx + yy), half = std::hypot(0.5 * (xx - yy), xy);
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  result.axis = Eigen::Vector2d(std::cos(angle), std::sin(angle));
  result.wide = std::sqrt(mean + half);
  result.thin = std::sqrt(std::max(0.0, mean - half));
  return result;
}

/// Maps a position in one flat section to another one: rotates it by the smaller angle, stretches
/// it along and across, and moves it.
inline Eigen::Vector2d
carried_across(const Section& from, const Section& to, const Eigen::Vector2d& position)
{
  const Eigen::Vector2d d = position - from.center;
  const Eigen::Vector2d axis = from.axis.dot(to.axis) < 0 ? Eigen::Vector2d(-to.axis) : to.axis;
  const double along = from.axis.dot(d) * to.wide / from.wide;
  const double across =
      (from.axis.x() * d.y() - from.axis.y() * d.x()) * (from.thin > 0 ? to.thin / from.thin : 1);
  return to.center + along * axis + across * Eigen::Vector2d(-axis.y(), axis.x());
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_FLAT_SECTIONS_H
