// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tube coordinates of points: along, around and away from an edge.

#ifndef PCS_SHAPE_SPACE_POINTS_TUBE_COORDINATES_H
#define PCS_SHAPE_SPACE_POINTS_TUBE_COORDINATES_H

#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcs {
namespace shape_space {

/*!
  An edge as a cone around the z axis of a frame. It ends at the planes that halve the angles to the
  edges before and behind it on the branch. So a surface along a bend does not tear when the bend
  grows, and sections across the axis keep their size. On the inner side of a bend, where tubes
  overlap, the planes end before the middle of the edge.
*/
struct Edge_cone
{
  Vec3 from;
  Eigen::Matrix3d frame;
  double length, from_radius, to_radius;
  Eigen::Vector2d begin_slope = Eigen::Vector2d::Zero(), end_slope = Eigen::Vector2d::Zero();

  static constexpr double inner_fraction = 0.4; ///< largest fraction of the edge cut off by a plane
  static constexpr double steepest = 2; ///< slope limit; bends by more than 127 degrees leave gaps

  double radius(double t) const { return (1 - t) * from_radius + t * to_radius; }
  /// Returns the height over the beginning of the edge at the fraction `t` between the planes. [L]
  double height(double x, double y, double t) const
  {
    const double begin =
        std::min(begin_slope.x() * x + begin_slope.y() * y, inner_fraction * length);
    const double end =
        length + std::max(end_slope.x() * x + end_slope.y() * y, -inner_fraction * length);
    return begin + t * (end - begin);
  }
};

/// Returns the slope, in the frame of an edge, of the plane that halves the angle between it and a
/// neighbour along `other`. [-]
inline Eigen::Vector2d joint_slope(const Eigen::Matrix3d& frame, const Vec3& other)
{
  const Vec3 local = frame.transpose() * other; // of unit length, as the edge's own direction
  const Eigen::Vector2d across = -local.head<2>();
  const double up = 1 + local.z(), size = across.norm(), most = Edge_cone::steepest;
  if (!(size > 0)) // straight on, or straight back
    return Eigen::Vector2d::Zero();
  return size < most * up ? Eigen::Vector2d(across / up) : Eigen::Vector2d(across * (most / size));
}

inline Edge_cone edge_cone(const Orl_layout& layout,
                           const Orl_geometry& geometry,
                           std::size_t branch,
                           std::size_t edge)
{
  const std::size_t k = edge - layout.branches[branch].first_edge;
  const std::size_t node = layout.first_node(branch) + k;
  Edge_cone result{geometry.node[node],
                   geometry.frame[edge].toRotationMatrix(),
                   (geometry.node[node + 1] - geometry.node[node]).norm(),
                   geometry.radius[node],
                   geometry.radius[node + 1]};
  if (k > 0)
    result.begin_slope = joint_slope(result.frame, geometry.frame[edge - 1] * Vec3::UnitZ());
  if (k + 1 < layout.branches[branch].number_of_edges)
    result.end_slope = joint_slope(result.frame, geometry.frame[edge + 1] * Vec3::UnitZ());
  return result;
}

/// A point relative to an edge: the parameter along it in [0, 1], the overshoot before or behind
/// it, and angle and distance from the axis. Overshoot and distance are in units of the radius if
/// `is_relative`, so that detail scales with the branch.
struct Tube_coordinates
{
  double t, overshoot, angle, distance;
};

inline Tube_coordinates tube_coordinates(const Edge_cone& edge, const Vec3& p, bool is_relative)
{
  const Vec3 q = edge.frame.transpose() * (p - edge.from);
  const double begin = edge.height(q.x(), q.y(), 0), width = edge.height(q.x(), q.y(), 1) - begin;
  const double t = width > 0 ? std::min(1.0, std::max(0.0, (q.z() - begin) / width)) : 0;
  const double unit = is_relative ? edge.radius(t) : 1;
  return {t,
          (q.z() - begin - t * width) / unit,
          std::atan2(q.y(), q.x()),
          q.head<2>().norm() / unit};
}

inline Vec3 point_of(const Edge_cone& edge, const Tube_coordinates& c, bool is_relative)
{
  const double unit = is_relative ? edge.radius(c.t) : 1;
  const double x = unit * c.distance * std::cos(c.angle), y = unit * c.distance * std::sin(c.angle);
  return edge.from + edge.frame * Vec3(x, y, edge.height(x, y, c.t) + unit * c.overshoot);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_TUBE_COORDINATES_H
