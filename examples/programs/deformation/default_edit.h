// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A default edit for any cloud: one end is fixed, the other is rotated and translated.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_DEFAULT_EDIT_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_DEFAULT_EDIT_H

#include "deformation/Edit.h"
#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace program {

/// The 1st and 99th percentile of the coordinates along one axis. [L]
struct Extent
{
  double low, high;
  double half() const { return 0.5 * high - 0.5 * low; } // the full extent may overflow
};

inline Extent robust_extent(const std::vector<pcs::IO::Point_table::Point_3>& points, int axis)
{
  std::vector<double> values;
  values.reserve(points.size());
  for (const auto& p : points)
    values.push_back(p[axis]);
  const auto quantile = [&](std::size_t rank) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const std::size_t tail = values.size() / 100;
  Extent extent{quantile(tail), quantile(values.size() - 1 - tail)};
  if (!(extent.low < extent.high))
    extent = {quantile(0), quantile(values.size() - 1)};
  return extent;
}

/// Makes an edit along the longest axis: the lowest 20 % are fixed; the highest 15 % are rotated by
/// 40 degrees about that axis and translated sideways by 10 % of the extent.
inline Edit default_edit(const std::vector<pcs::IO::Point_table::Point_3>& points)
{
  if (points.empty())
    throw pcs::Invalid_input("default edit: there are no points");
  int axis = 0;
  Extent extent = robust_extent(points, 0);
  for (int a = 1; a < 3; ++a)
    if (const Extent other = robust_extent(points, a); other.half() > extent.half()) {
      axis = a;
      extent = other;
    }
  const double half = extent.half();
  const double foot = extent.low + 0.4 * half, head = extent.high - 0.3 * half;
  if (!(foot < head))
    throw pcs::Invalid_input(
        "default edit: the points lie too close together to separate a foot from a head");

  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box lowest{Vec3::Constant(-infinity), Vec3::Constant(infinity)}, highest = lowest;
  lowest.high[axis] = foot;
  highest.low[axis] = head;
  Handle fixed{"the foot", lowest, {}};
  Handle moved{"the head", highest, {}};
  moved.motion.rotation = Rotation{Vec3::Unit(axis), 40, std::nullopt};
  moved.motion.translation = 0.2 * half * Vec3::Unit((axis + 1) % 3);
  return {"default edit", {fixed, moved}};
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_DEFAULT_EDIT_H
