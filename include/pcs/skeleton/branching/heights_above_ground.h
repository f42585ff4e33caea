// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Heights of the ends of axes above the ground, for axes that may stand on it beside the tree.

#ifndef PCS_SKELETON_BRANCHING_HEIGHTS_ABOVE_GROUND_H
#define PCS_SKELETON_BRANCHING_HEIGHTS_ABOVE_GROUND_H

#include <pcs/skeleton/clutter/Ground.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Heights of both ends of every axis above the ground [L]: at index 0 that of the first node.
using End_heights = std::vector<std::array<double, 2>>;

/*!
  Returns the heights of the lower sides of the ends of axes above the ground; empty if no ground or
  no foot was found. Ends within `apart` stem widths of the foot are at the stem, and have infinite
  heights. O(axes).
*/
inline End_heights
heights_above_ground(const Scan& scan, const Axis_set& set, const Ground& ground, double apart)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!ground.terrain || !ground.foot)
    return {};
  const Stem_foot& foot = *ground.foot;
  const auto height = [&](const Axis_node& end) {
    const Vec3 d = end.point - foot.center;
    const double distance = (d - ground.up.dot(d) * ground.up).norm();
    if (distance <= apart * foot.width + 4 * scan.spacing)
      return infinity;
    return std::max(0.0, ground.height(end.point) - end.radius);
  };
  End_heights heights;
  for (const Fitted_axis& fitted : set.axes)
    heights.push_back({height(fitted.axis.front()), height(fitted.axis.back())});
  return heights;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_HEIGHTS_ABOVE_GROUND_H
