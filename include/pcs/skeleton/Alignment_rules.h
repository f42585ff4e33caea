// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What tells how stations must move.

#ifndef PCS_SKELETON_ALIGNMENT_RULES_H
#define PCS_SKELETON_ALIGNMENT_RULES_H

#include <cstddef>

namespace pcs {
namespace skeleton {

/// Which points tell where stations are, and what else their distances from the axes may come from.
struct Alignment_rules
{
  double thickness = 3;      ///< smallest radius, in noise [-]
  std::size_t fewest = 40;   ///< points of a piece of a branch [count]
  std::size_t enough = 60;   ///< the same of two edges, unless more are needed [count]
  double fit = 3;            ///< error of a radius or place that was fitted, in noise ... [-]
  double relative_fit = 0.2; ///< ... and in radii [-]
  double oval = 0.03;        ///< half difference of the half axes of a section, in radii [-]
  double largest_error = 4.685; ///< of a point, in noise (Tukey's constant) [-]
  double motion = 5;            ///< usual size, in noise [-]
  int rounds = 6;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_ALIGNMENT_RULES_H
