// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Orientation-radius-length coordinates of a tree, its metric, and its geometry in space.

#ifndef PCS_SHAPE_SPACE_MODEL_ORL_COORDINATES_H
#define PCS_SHAPE_SPACE_MODEL_ORL_COORDINATES_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/rotations.h>
#include <pcs/shape_space/model/Rooted_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Edges and branches of a topology. Edges of a branch are consecutive, parents come first. Node 0
/// of branch `b` is at `first_edge + b` in lists of nodes.
struct Orl_layout
{
  struct Branch
  {
    std::size_t parent = none; ///< branch
    std::size_t first_edge = 0, number_of_edges = 0;
    std::size_t reference_edge =
        none; ///< edge of the parent that the orientation of the first edge refers to
  };
  std::vector<Branch> branches;
  std::vector<std::size_t>
      edge_before; ///< from which frames are transported: on the branch, or the reference edge
  std::vector<std::size_t>
      /// to which the orientation refers, see `set_parent_edges()`; `none`: the axes of the input
      parent_edge;

  std::size_t number_of_edges() const { return edge_before.size(); }
  std::size_t number_of_nodes() const { return edge_before.size() + branches.size(); }
  std::size_t first_node(std::size_t b) const { return branches[b].first_edge + b; }
};

/*!
  Sets the edges to which orientations refer. With `gauge_fixed`, an edge refers to the first edge
  of its branch. If each edge refers to the previous one, as published [Aiteanu 2022], halving many
  small rotations about different axes does not halve their product, so noise of an axis rotates
  everything beyond it. In both cases, a branch that is rotated as a whole differs only by the
  rotation of its first edge.
*/
inline void set_parent_edges(Orl_layout& layout, Orl_orientation kind)
{
  layout.parent_edge = layout.edge_before;
  if (kind == Orl_orientation::gauge_fixed)
    for (const Orl_layout::Branch& b : layout.branches)
      for (std::size_t j = 1; j < b.number_of_edges; ++j)
        layout.parent_edge[b.first_edge + j] = b.first_edge;
}

/// A tree of the space.
struct Orl_coordinates
{
  Vec3 root = Vec3::Zero();            ///< [L]
  std::vector<Quaternion> orientation; ///< per edge
  std::vector<double> length, radius;  ///< per edge; the radius at its end [L]
  std::vector<double> base_radius;     ///< per branch [L]
  std::vector<double>
      attachment; ///< per branch: number of a node of the parent, plus fraction of the next edge
};

/// The geometry of a tree in space. Buffers are reused.
struct Orl_geometry
{
  std::vector<Vec3> node;        ///< relative to the origin of the space [L]
  std::vector<double> radius;    ///< per node [L]
  std::vector<Quaternion> frame; ///< per edge; the z axis is its direction
};

inline Quaternion turn_about_z(double angle)
{
  return Quaternion(std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle));
}

/// Returns the shortest rotation from one unit vector to another. For opposite vectors, its axis is
/// perpendicular to them, and to the x or y axis.
inline Quaternion shortest_turn(const Vec3& from, const Vec3& to)
{
  const double c = from.dot(to);
  if (c < -1 + 1e-12) {
    const Vec3 other = std::abs(from.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 axis = from.cross(other).normalized();
    return Quaternion(0, axis.x(), axis.y(), axis.z());
  }
  const Vec3 axis = from.cross(to);
  Quaternion q(1 + c, axis.x(), axis.y(), axis.z());
  q.normalize();
  return q;
}

/// Returns the position on branch `b` at `t`, the number of a node plus the fraction of the next
/// edge. [L]
inline Vec3
place_on_branch(const Orl_layout& layout, const Orl_geometry& geometry, std::size_t b, double t)
{
  const std::size_t first = layout.first_node(b), n = layout.branches[b].number_of_edges;
  const double clamped = std::min(static_cast<double>(n), std::max(0.0, t));
  const auto k = std::min(n - 1, static_cast<std::size_t>(clamped));
  const double f = clamped - static_cast<double>(k);
  if (f == 0)
    return geometry.node[first + k];
  return (1 - f) * geometry.node[first + k] + f * geometry.node[first + k + 1];
}

inline Quaternion compose(Orl_orientation kind, const Quaternion& parent, const Quaternion& q)
{
  return kind == Orl_orientation::world_axes ? q * parent : parent * q;
}
inline Quaternion relative(Orl_orientation kind, const Quaternion& parent, const Quaternion& frame)
{
  return kind == Orl_orientation::world_axes ? frame * parent.conjugate()
                                             : parent.conjugate() * frame;
}

inline void build_geometry(const Orl_layout& layout,
                           const Orl_coordinates& x,
                           Orl_orientation kind,
                           Orl_geometry& result)
{
  result.node.resize(layout.number_of_nodes());
  result.radius.resize(layout.number_of_nodes());
  result.frame.resize(layout.number_of_edges());
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    const std::size_t first = layout.first_node(b);
    result.node[first] = branch.parent == none
                             ? x.root
                             : place_on_branch(layout, result, branch.parent, x.attachment[b]);
    result.radius[first] = x.base_radius[b];
    for (std::size_t j = 0; j < branch.number_of_edges; ++j) {
      const std::size_t e = branch.first_edge + j;
      const std::size_t p = layout.parent_edge[e];
      result.frame[e] =
          p == none ? x.orientation[e] : compose(kind, result.frame[p], x.orientation[e]);
      result.frame[e].normalize();
      result.node[first + j + 1] =
          result.node[first + j] + x.length[e] * (result.frame[e] * Vec3::UnitZ());
      result.radius[first + j + 1] = x.radius[e];
    }
  }
}

/// Returns the orders of the branches of a tree, 0 for the trunk, and `none` for branches that are
/// not longer than `least_length` [L], and their subtrees.
inline std::vector<std::size_t>
orders_of_branches(const Orl_layout& layout, const Orl_coordinates& x, double least_length = 0)
{
  std::vector<std::size_t> order(layout.branches.size(), none);
  for (std::size_t b = 0; b < order.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    double length = 0;
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      length += x.length[branch.first_edge + j];
    if (branch.parent == none)
      order[b] = 0;
    else if (length > least_length && order[branch.parent] != none)
      order[b] = order[branch.parent] + 1;
  }
  return order;
}

/// Returns the angle between two orientations, in [0, pi], whatever the signs of the quaternions.
/// [rad]
inline double angle_between(const Quaternion& a, const Quaternion& b)
{
  const Quaternion d = a.conjugate() * b; // atan2 keeps small angles, acos would not
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

/// Weights of the metric, one per coordinate; the same for all trees of a space.
struct Orl_weights
{
  std::vector<double> orientation, length, radius; ///< per edge
  std::vector<double> base_radius, attachment;     ///< per branch
  double root = 1;
};

/// Returns the distance (4.7) of \cite aiteanu2022, without weights: over all edges `e`,
///
///     d = sum_e |r_e - r'_e| + |s_e - s'_e| + 2 acos |<q_e, q'_e>|.
inline double published_distance(const Orl_coordinates& x, const Orl_coordinates& y)
{
  double total = 0;
  for (std::size_t e = 0; e < x.length.size(); ++e)
    total += std::abs(x.radius[e] - y.radius[e]) + std::abs(x.length[e] - y.length[e]) +
             angle_between(x.orientation[e], y.orientation[e]);
  return total;
}

inline double distance(const Orl_coordinates& x,
                       const Orl_coordinates& y,
                       const Orl_weights& w,
                       Orl_metric metric)
{
  if (metric == Orl_metric::published)
    return published_distance(x, y);
  double total = 0;
  const auto add = [&](double difference) {
    total += metric == Orl_metric::square ? difference * difference : std::abs(difference);
  };
  add(w.root * (x.root - y.root).norm());
  for (std::size_t e = 0; e < x.length.size(); ++e) {
    const double angle = angle_between(x.orientation[e], y.orientation[e]);
    add(metric == Orl_metric::cone ? std::min(x.length[e], y.length[e]) * std::min(angle, 2.0)
                                   : w.orientation[e] * angle);
    add(w.length[e] * (x.length[e] - y.length[e]));
    add(w.radius[e] * (x.radius[e] - y.radius[e]));
  }
  for (std::size_t b = 0; b < x.attachment.size(); ++b) {
    add(w.base_radius[b] * (x.base_radius[b] - y.base_radius[b]));
    add(w.attachment[b] * (x.attachment[b] - y.attachment[b]));
  }
  return metric == Orl_metric::square ? std::sqrt(total) : total;
}

/// A quantity that shrinks beyond an end of the path keeps this fraction of its value at the end.
/// Otherwise edges nearly vanish, and all branches that grow on them gather at one position. [-]
constexpr double least_beyond_end = 0.5;

/// Returns the value at `t` of a non-negative quantity: linear between `x` and `y`, and also
/// beyond an end if it grows there. If it shrinks there, it begins with the same slope and decays
/// towards the fraction `least_beyond_end` of its value at the end.
inline double positive_value(double x, double y, double t)
{
  if (t >= 0 && t <= 1)
    return (1 - t) * x + t * y;
  const double end = t > 1 ? y : x, step = t > 1 ? y - x : x - y, beyond = t > 1 ? t - 1 : -t;
  if (step >= 0 || end <= 0)
    return end > 0 ? end + beyond * step : 0;
  constexpr double rest = 1 - least_beyond_end;
  return end * (least_beyond_end + rest * std::exp(beyond * step / (rest * end)));
}

/// Returns the same for a quantity in [0, `last`]. Beyond an end, its distance from the bound that
/// it approaches decays likewise, so branches that move along their parent do not gather at its
/// end.
inline double bounded_value(double x, double y, double t, double last)
{
  if (t >= 0 && t <= 1)
    return (1 - t) * x + t * y;
  const bool is_falling = t > 1 ? y < x : x < y;
  return is_falling ? std::min(last, positive_value(x, y, t))
                    : std::max(0.0, last - positive_value(last - x, last - y, t));
}

/// Returns the orientation at `t`; beyond an end it rotates by at most `max_extrapolation_angle`.
/// [rad]
inline Quaternion
orientation_at(const Quaternion& x, const Quaternion& y, double t, double max_extrapolation_angle)
{
  if (t == 0)
    return x;
  if (t == 1)
    return y;
  const Vec3 u = rotation_log(x.conjugate() * y);
  const double angle = u.norm();
  if (t > 1 && angle * (t - 1) > max_extrapolation_angle)
    t = 1 + max_extrapolation_angle / angle;
  else if (t < 0 && -angle * t > max_extrapolation_angle)
    t = -max_extrapolation_angle / angle;
  Quaternion q = x * rotation_exp(t * u);
  q.normalize();
  return q;
}

/// Computes the tree at `t` on the path from `x` (0) to `y` (1) and beyond. With `linear`, lengths,
/// radii and attachments continue linearly beyond the ends, within their range.
inline void coordinates_at(const Orl_layout& layout,
                           const Orl_coordinates& x,
                           const Orl_coordinates& y,
                           double t,
                           double max_extrapolation_angle,
                           Orl_coordinates& result,
                           Orl_extrapolation kind = Orl_extrapolation::bounded)
{
  const auto positive = [&](double a, double b) {
    return kind == Orl_extrapolation::linear ? std::max(0.0, (1 - t) * a + t * b)
                                             : positive_value(a, b, t);
  };
  const auto bounded = [&](double a, double b, double last) {
    return kind == Orl_extrapolation::linear ? std::min(last, std::max(0.0, (1 - t) * a + t * b))
                                             : bounded_value(a, b, t, last);
  };
  const std::size_t n = layout.number_of_edges(), m = layout.branches.size();
  result.root = (1 - t) * x.root + t * y.root;
  result.orientation.resize(n);
  result.length.resize(n);
  result.radius.resize(n);
  result.base_radius.resize(m);
  result.attachment.resize(m);
  for (std::size_t e = 0; e < n; ++e) {
    result.orientation[e] =
        orientation_at(x.orientation[e], y.orientation[e], t, max_extrapolation_angle);
    result.length[e] = positive(x.length[e], y.length[e]);
    result.radius[e] = positive(x.radius[e], y.radius[e]);
  }
  for (std::size_t b = 0; b < m; ++b) {
    result.base_radius[b] = positive(x.base_radius[b], y.base_radius[b]);
    const std::size_t p = layout.branches[b].parent;
    const double last = p == none ? 0 : static_cast<double>(layout.branches[p].number_of_edges);
    result.attachment[b] = bounded(x.attachment[b], y.attachment[b], last);
  }
}

/// Limits each radius to the previous one on the branch, and base radii to the radius of the
/// parent.
inline void limit_radii(const Orl_layout& layout, Orl_coordinates& x)
{
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    if (branch.parent != none) {
      const Orl_layout::Branch& parent = layout.branches[branch.parent];
      const auto k = std::min(parent.number_of_edges, static_cast<std::size_t>(x.attachment[b]));
      const auto next = std::min(parent.number_of_edges, k + 1);
      const auto at = [&](std::size_t i) {
        return i == 0 ? x.base_radius[branch.parent] : x.radius[parent.first_edge + i - 1];
      };
      const double f = x.attachment[b] - static_cast<double>(k);
      x.base_radius[b] = std::min(x.base_radius[b], (1 - f) * at(k) + f * at(next));
    }
    double above = x.base_radius[b];
    for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e)
      above = x.radius[e] = std::min(x.radius[e], above);
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_ORL_COORDINATES_H
