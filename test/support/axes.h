// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axes of branches for tests of the skeleton's stages.

#ifndef PCS_TEST_SUPPORT_AXES_H
#define PCS_TEST_SUPPORT_AXES_H

#include <pcs/skeleton/Axis.h>
#include <pcs/skeleton/Axis_set.h>

#include <cstddef>
#include <vector>

namespace pcs_test {

/// A straight axis of equal steps, with radii that change evenly.
inline pcs::skeleton::Axis straight_axis(const pcs::skeleton::Vec3& from,
                                         const pcs::skeleton::Vec3& to,
                                         std::size_t steps,
                                         double first_radius,
                                         double last_radius)
{
  pcs::skeleton::Axis axis;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double t = double(k) / double(steps);
    pcs::skeleton::Axis_node node;
    node.point = from + t * (to - from);
    node.radius = first_radius + t * (last_radius - first_radius);
    axis.push_back(node);
  }
  return axis;
}

/// One point per segment of each axis.
inline pcs::skeleton::Axis_set set_of(const std::vector<pcs::skeleton::Axis>& axes)
{
  using pcs::skeleton::Index;
  pcs::skeleton::Axis_set set;
  for (const pcs::skeleton::Axis& axis : axes) {
    for (Index s = 0; s + 1 < axis.size(); ++s) {
      set.axis_of_point.push_back(static_cast<Index>(set.axes.size()));
      set.segment_of_point.push_back(s);
    }
    set.axes.push_back({axis, pcs::skeleton::none, axis.size() - 1, 1});
  }
  return set;
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_AXES_H
