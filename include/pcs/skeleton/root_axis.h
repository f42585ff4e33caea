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

/// The axis that explains the root, and most else: a trunk may stand on buttresses that have more of the root. If none
/// does, the nearest one. `root` has points, `set` axes. O(axes + root).
inline Index root_axis(const Scan& scan, const Axis_set& set, const std::vector<Index>& root)
{
  std::vector<double> votes(set.axes.size(), 0);
  for (const Index i : root)
    if (set.is_covered(i))
      votes[set.axis_of_point[i]] += double(set.axes[set.axis_of_point[i]].number_of_points);
  const auto most = std::max_element(votes.begin(), votes.end());
  if (*most > 0)
    return static_cast<Index>(most - votes.begin());
  Index best = 0;
  double distance = std::numeric_limits<double>::infinity();
  for (Index a = 0; a < set.axes.size(); ++a) {
    const double d = nearest_place(set.axes[a].axis, scan.points[root.front()]).distance;
    if (d < distance) {
      distance = d;
      best = a;
    }
  }
  return best;
}

/// Whether the root lies at the tip of its axis.
inline bool is_root_reversed(const Scan& scan, const Axis& axis, const std::vector<Index>& root)
{
  Vec3 mean = Vec3::Zero();
  for (const Index i : root)
    mean += scan.points[i];
  mean /= double(root.size());
  return (axis.back().point - mean).norm() < (axis.front().point - mean).norm();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_ROOT_AXIS_H
