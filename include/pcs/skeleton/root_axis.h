// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Which axis stands on the root, and which of its ends.

#ifndef PCS_SKELETON_ROOT_AXIS_H
#define PCS_SKELETON_ROOT_AXIS_H

#include <pcs/skeleton/Axis.h>
#include <pcs/skeleton/Axis_set.h>
#include <pcs/skeleton/Scan.h>

#include <algorithm>
#include <limits>
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

/*!
  The axis that explains the root, and most else: a trunk may stand on buttresses that have more of the root. If none does, the
  nearest one. Instead of one that is small beside an axis which the root is near, too, that: chance pieces of a
  foot may have all of the root, unless the caller gave it (`is_given`). `root` has points, `set` axes. O(axes + root).
*/
inline Index
root_axis(const Scan& scan, const Axis_set& set, const std::vector<Index>& root, bool is_given)
{
  constexpr double small = 0.1, near = 4; // share of the points, radii from the axis
  const auto points_of = [&](Index a) { return double(set.axes[a].number_of_points); };
  const Vec3 middle = middle_of(scan, root);
  std::vector<double> votes(set.axes.size(), 0);
  for (const Index i : root)
    if (set.is_covered(i))
      votes[set.axis_of_point[i]] += points_of(set.axis_of_point[i]);
  Index nearest = 0, largest = none;
  double distance = std::numeric_limits<double>::infinity();
  for (Index a = 0; a < set.axes.size(); ++a) {
    const Axis& axis = set.axes[a].axis;
    const double d = nearest_place(axis, scan.points[root.front()]).distance;
    if (d < distance) {
      distance = d;
      nearest = a;
    }
    const Axis_place place = nearest_place(axis, middle);
    if (place.distance <= near * radius_at(axis, place) &&
        (largest == none || points_of(a) > points_of(largest)))
      largest = a;
  }
  const auto most = std::max_element(votes.begin(), votes.end());
  const Index best = *most > 0 ? static_cast<Index>(most - votes.begin()) : nearest;
  return !is_given && largest != none && points_of(best) < small * points_of(largest) ? largest
                                                                                      : best;
}

/// Whether the root lies at the tip of its axis.
inline bool is_root_reversed(const Scan& scan, const Axis& axis, const std::vector<Index>& root)
{
  const Vec3 middle = middle_of(scan, root);
  return (axis.back().point - middle).norm() < (axis.front().point - middle).norm();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_ROOT_AXIS_H
