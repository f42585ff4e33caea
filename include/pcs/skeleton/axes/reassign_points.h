// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Assignment of removed points to the axes whose surfaces they lie on.

#ifndef PCS_SKELETON_AXES_REASSIGN_POINTS_H
#define PCS_SKELETON_AXES_REASSIGN_POINTS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Assigns points that were classified as leaves but lie on the surface of an axis to that axis.
/// Returns their number.
template <class ConcurrencyTag>
std::size_t reassign_points(const Scan& scan,
                            const Chain_options& rules,
                            std::vector<std::uint8_t>& is_leaf,
                            Axis_set& set)
{
  const std::size_t n = scan.size();
  std::vector<Index> axis_of(n, none), segment_of(n, none);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t i) {
        const Vec3& p = scan.points[i];
        if (!is_leaf[i])
          return;
        const auto near = scan.search->nearest_if(p, 4 * scan.spacing, [&](Index j) {
          return set.is_covered(j);
        });
        if (!(near.squared_distance < 16 * scan.spacing * scan.spacing))
          return;
        const Index a = set.axis_of_point[near.index];
        const Axis& axis = set.axes[a].axis;
        const Axis_place place = nearest_place(axis, set.segment_of_point[near.index], p);
        const double r = radius_at(axis, place);
        if (place.distance >
            r + std::max(rules.cover_offset * scan.spacing, rules.cover_factor * r))
          return;
        axis_of[i] = a;
        segment_of[i] = place.segment;
      },
      256);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (axis_of[i] != none) {
      set.axis_of_point[i] = axis_of[i];
      set.segment_of_point[i] = segment_of[i];
      ++set.axes[axis_of[i]].number_of_points;
      is_leaf[i] = 0;
      ++count;
    }
  return count;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_REASSIGN_POINTS_H
