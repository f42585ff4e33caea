// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The reach of branches from the stem, by the shape of the crown.

#ifndef PCS_GENERATORS_INTERNAL_CROWN_REACH_H
#define PCS_GENERATORS_INTERNAL_CROWN_REACH_H

#include <pcs/generators/Tree_habit.h>

#include <algorithm>
#include <cmath>

namespace pcs {
namespace generators {
namespace internal {

/// Returns the reach of a branch that leaves a stem at the fraction `x` of the crown.
inline double crown_reach(Crown_shape shape, double crown_radius, double x)
{
  switch (shape) {
  case Crown_shape::cone:
    return crown_radius * (0.06 + 0.94 * (1 - x));
  case Crown_shape::vase:
    return crown_radius * std::min(0.5 + 0.8 * x, 2.6 * (1.1 - x));
  case Crown_shape::dome:
    break;
  }
  const double y = x < 0.35 ? 0.6 * (0.35 - x) / 0.35 : (x - 0.35) / 0.7;
  return crown_radius * std::sqrt(std::max(0.01, 1 - y * y));
}

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_CROWN_REACH_H
