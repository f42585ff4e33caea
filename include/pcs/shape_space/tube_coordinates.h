// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points in the frame of an edge: along, around and away from it.

#ifndef PCS_SHAPE_SPACE_TUBE_COORDINATES_H
#define PCS_SHAPE_SPACE_TUBE_COORDINATES_H

#include <pcs/shape_space/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcs {
namespace shape_space {

/// An edge as a cone around the z axis of a frame.
struct Edge_cone
{
  Vec3 from;
  Eigen::Matrix3d frame;
  double length, from_radius, to_radius;

  double radius(double t) const { return (1 - t) * from_radius + t * to_radius; }
};

inline Edge_cone edge_cone(const Orl_layout& layout,
                           const Orl_geometry& geometry,
                           std::size_t branch,
                           std::size_t edge)
{
  const std::size_t node = layout.first_node(branch) + edge - layout.branches[branch].first_edge;
  return {geometry.node[node],
          geometry.frame[edge].toRotationMatrix(),
          (geometry.node[node + 1] - geometry.node[node]).norm(),
          geometry.radius[node],
          geometry.radius[node + 1]};
}

/// A point relative to an edge: the share of the edge, how far it lies before or behind it, angle and distance from the
/// axis. Lengths off the axis are shares of the radius if `is_relative`, so that detail grows with the branch.
struct Tube_coordinates
{
  double t, overshoot, angle, distance;
};

inline Tube_coordinates tube_coordinates(const Edge_cone& edge, const Vec3& p, bool is_relative)
{
  const Vec3 q = edge.frame.transpose() * (p - edge.from);
  const double t = edge.length > 0 ? std::min(1.0, std::max(0.0, q.z() / edge.length)) : 0;
  const double unit = is_relative ? edge.radius(t) : 1;
  return {t, (q.z() - t * edge.length) / unit, std::atan2(q.y(), q.x()), q.head<2>().norm() / unit};
}

inline Vec3 point_of(const Edge_cone& edge, const Tube_coordinates& c, bool is_relative)
{
  const double unit = is_relative ? edge.radius(c.t) : 1;
  const Vec3 q(unit * c.distance * std::cos(c.angle),
               unit * c.distance * std::sin(c.angle),
               c.t * edge.length + unit * c.overshoot);
  return edge.from + edge.frame * q;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TUBE_COORDINATES_H
