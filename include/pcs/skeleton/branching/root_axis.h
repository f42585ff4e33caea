// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Selection of the axis at the root, and of the end of this axis at the root.

#ifndef PCS_SKELETON_BRANCHING_ROOT_AXIS_H
#define PCS_SKELETON_BRANCHING_ROOT_AXIS_H

#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace pcs {
namespace skeleton {

inline Vec3 middle_of(const Scan& scan, const std::vector<Index>& points)
{
  Vec3 sum = Vec3::Zero();
  for (const Index i : points)
    sum += scan.points[i];
  return sum / double(points.size());
}

inline Index nearest_axis(const Axis_set& set, const Vec3& p)
{
  Index best = 0;
  double distance = std::numeric_limits<double>::infinity();
  for (Index a = 0; a < set.axes.size(); ++a) {
    const double d = nearest_place(set.axes[a].axis, p).distance;
    if (d < distance) {
      distance = d;
      best = a;
    }
  }
  return best;
}

/*!
  Selects the axis of the root: the one with the largest product of its numbers of root points and
  of all points. The second factor matters because the buttresses of a trunk may have more root
  points than the trunk. If no axis has root points, selects the nearest axis. A small axis is
  replaced by a much larger one close to the root, since a small axis in the foot may have all root
  points. A given root (`hint`, in coordinates of the scan) replaces the mean of the root points.
  `root` and `set` are not empty. O(axes + root).
*/
inline Index root_axis(const Scan& scan,
                       const Axis_set& set,
                       const std::vector<Index>& root,
                       const std::optional<Vec3>& hint)
{
  constexpr double small = 0.1; // fraction of the points
  constexpr double near = 4;    // distance from the larger axis in radii
  const auto points_of = [&](Index a) { return double(set.axes[a].number_of_points); };
  std::vector<double> votes(set.axes.size(), 0);
  for (const Index i : root)
    if (set.is_covered(i))
      votes[set.axis_of_point[i]] += points_of(set.axis_of_point[i]);
  const auto most = std::max_element(votes.begin(), votes.end());
  const Index best = *most > 0 ? static_cast<Index>(most - votes.begin())
                               : nearest_axis(set, scan.points[root.front()]);
  const Vec3 middle = hint ? *hint : middle_of(scan, root);
  Index largest = best;
  for (Index a = 0; a < set.axes.size(); ++a) {
    if (small * points_of(a) <= points_of(best) || points_of(a) <= points_of(largest))
      continue;
    const Axis_place place = nearest_place(set.axes[a].axis, middle);
    if (place.distance <= near * radius_at(set.axes[a].axis, place))
      largest = a;
  }
  return largest;
}

/// Returns whether the root lies at the tip of its axis.
inline bool is_root_reversed(const Scan& scan, const Axis& axis, const std::vector<Index>& root)
{
  const Vec3 middle = middle_of(scan, root);
  return (axis.back().point - middle).norm() < (axis.front().point - middle).norm();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_ROOT_AXIS_H
