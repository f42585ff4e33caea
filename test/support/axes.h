// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axes of branches for tests of the skeleton's stages.

#ifndef PCS_TEST_SUPPORT_AXES_H
#define PCS_TEST_SUPPORT_AXES_H

#include <pcs/skeleton/Axis.h>

#include <cstddef>

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

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_AXES_H
