// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Alignment of the base of the trunk with the root.

#ifndef PCS_SKELETON_BRANCHING_ALIGN_BASE_WITH_ROOT_H
#define PCS_SKELETON_BRANCHING_ALIGN_BASE_WITH_ROOT_H

#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of `align_base_with_root()`.
struct Base_alignment_options
{
  double sound = 4;          ///< length that defines the direction of the base, in radii [-] ...
  double sound_spacings = 8; ///< ... and in spacings, whichever is larger [-]
  double lateral = 4;    ///< largest distance of the root from the line of the base, in radii [-]
  double longest = 0.25; ///< largest change, and length of the lowest part of the trunk, as a
                         ///< fraction of the length of the axis [-]
  double step = 0.5;     ///< distance of added nodes, in radii [-]
  double steep = 0.7;    ///< least rise per length of a trunk that is measured vertically [-]
};

namespace internal {

/// Returns the unit vector from the base into the axis; zero if the axis has no length.
inline Vec3 direction_of_base(const Axis& axis, double length)
{
  std::size_t k = 1;
  while (k + 1 < axis.size() && (axis[k].point - axis[0].point).norm() < length)
    ++k;
  const Vec3 d = axis[k].point - axis[0].point;
  return d.norm() > 0 ? Vec3(d.normalized()) : Vec3(Vec3::Zero());
}

/// Cuts an axis at the coordinate `t` along `n`: removes the nodes below, and adds one there.
inline void cut_base(const Vec3& n, double t, Axis& axis)
{
  constexpr double most = 0.9; // of an edge, so that no two nodes coincide [-]
  const Vec3 base = axis[0].point;
  const auto at = [&](std::size_t k) { return (axis[k].point - base).dot(n); };
  std::size_t k = 0;
  while (k + 2 < axis.size() && at(k + 1) < t)
    ++k;
  const double from = at(k), to = at(k + 1);
  const double share = to > from ? std::min(most, std::max(0.0, (t - from) / (to - from))) : 0;
  axis[k].point += share * (axis[k + 1].point - axis[k].point);
  axis[k].radius += share * (axis[k + 1].radius - axis[k].radius);
  axis.erase(axis.begin(), axis.begin() + static_cast<std::ptrdiff_t>(k));
}

/// Moves the base by `piece` if that is at most `step` long. Otherwise adds nodes at equal
/// distances of at most `step`.
inline void extend_base(const Vec3& piece, double step, Axis& axis)
{
  if (piece.norm() <= step) {
    axis[0].point += piece;
    return;
  }
  const auto count = static_cast<std::size_t>(std::ceil(piece.norm() / step));
  Axis_node node = axis[0];
  node.is_measured = false;
  node.radius_error = node.radius;
  std::vector<Axis_node> added(count, node);
  for (std::size_t k = 0; k < count; ++k)
    added[k].point += (double(count - k) / double(count)) * piece;
  axis.insert(axis.begin(), added.begin(), added.end());
}

/// Renumbers the segments of the points of an axis after its first nodes were added or removed.
/// `before` and `after` are the numbers of its nodes.
inline void shift_segments(Index a, std::size_t before, std::size_t after, Axis_set& set)
{
  const auto shifted = [&](std::size_t k) {
    return after >= before ? k + (after - before) : k - std::min(k, before - after);
  };
  if (set.axes[a].meeting > 0)
    set.axes[a].meeting = shifted(set.axes[a].meeting);
  for (std::size_t i = 0; i < set.axis_of_point.size(); ++i)
    if (set.axis_of_point[i] == a)
      set.segment_of_point[i] = static_cast<Index>(shifted(set.segment_of_point[i]));
}

/// Lets all points of an axis of `size` nodes refer to existing segments.
inline void clamp_segments(Index a, std::size_t size, Axis_set& set)
{
  if (set.axes[a].meeting + 1 > size)
    set.axes[a].meeting = 0;
  for (std::size_t i = 0; i < set.axis_of_point.size(); ++i)
    if (set.axis_of_point[i] == a)
      set.segment_of_point[i] = std::min(set.segment_of_point[i], static_cast<Index>(size - 2));
}

} // namespace internal

/*!
  Lets the axis of the root begin at the root. Fits at the foot of a trunk follow single buttresses,
  so that an axis may begin above the foot, or below all points. The root was found from all points
  and is more reliable.

  With the base `b` of the axis, its unit direction `d` into the axis, and the points `p_i` of the
  root, the new base is at the coordinate

      t = min_i (p_i - b) . n                                                              [L]

  along `n`. This is the vertical if the lowest part of the trunk rises by at least `steep` per
  length, and `d` otherwise; z points upwards. The axis is cut there if `t > 0`, and extended by a
  straight piece if `t < 0`: along `d`, or along the lowest part of the trunk if `d` follows a
  buttress, `d . n < steep`. Nothing changes if the root is too far from the line of the base, or if
  `|t|` is too large for the length of the axis. The base is the first node, or the last one if
  `is_reversed`. Points of removed segments count for the first remaining one. Returns `t`, or 0 if
  nothing changed. O(points).
*/
inline double align_base_with_root(const Scan& scan,
                                   const std::vector<Index>& root,
                                   Index trunk,
                                   bool is_reversed,
                                   const Base_alignment_options& rules,
                                   Axis_set& set)
{
  Axis& axis = set.axes[trunk].axis;
  if (axis.size() < 2 || root.empty())
    return 0;
  Axis turned = axis;
  if (is_reversed)
    std::reverse(turned.begin(), turned.end());
  const double radius = std::max(turned[0].radius, scan.spacing), length = length_of(axis);
  const double sound = std::max(rules.sound * radius, rules.sound_spacings * scan.spacing);
  const Vec3 trunk_direction =
      internal::direction_of_base(turned, std::max(sound, rules.longest * length));
  Vec3 d = internal::direction_of_base(turned, sound);
  const Vec3 n = trunk_direction.z() >= rules.steep ? Vec3(Vec3::UnitZ()) : d;
  if (d.dot(n) < rules.steep) // along a buttress
    d = trunk_direction;
  double t = std::numeric_limits<double>::infinity();
  Vec3 mean = Vec3::Zero();
  for (const Index i : root) {
    const Vec3 p = scan.points[i] - turned[0].point;
    t = std::min(t, p.dot(n));
    mean += p / double(root.size());
  }
  const double lateral = (mean - mean.dot(d) * d).norm();
  if (t == 0 || d.isZero() || lateral > rules.lateral * radius ||
      std::abs(t) > rules.longest * length)
    return 0;
  const std::size_t before = turned.size();
  if (t > 0)
    internal::cut_base(n, t, turned);
  else
    internal::extend_base(t / d.dot(n) * d, rules.step * radius, turned);
  const std::size_t after = turned.size();
  if (is_reversed)
    std::reverse(turned.begin(), turned.end());
  axis = std::move(turned);
  if (!is_reversed)
    internal::shift_segments(trunk, before, after, set);
  internal::clamp_segments(trunk, after, set);
  return t;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_ALIGN_BASE_WITH_ROOT_H
