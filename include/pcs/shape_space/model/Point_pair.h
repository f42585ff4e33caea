// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Corresponding points of two trees.

#ifndef PCS_SHAPE_SPACE_MODEL_POINT_PAIR_H
#define PCS_SHAPE_SPACE_MODEL_POINT_PAIR_H

#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_report.h>

#include <cstddef>
#include <cstdint>

namespace pcs {
namespace shape_space {

constexpr std::uint32_t no_point = Orl_correspondences::no_point;

/// A point of tree 1 and one of tree 2, on an edge. One of them may be missing.
using Point_pair = Orl_correspondences::Pair;

struct Transport_summary
{
  std::size_t number_of_windows = 0;
  std::size_t number_of_failures = 0; ///< windows without convergence
  double worst_violation = 0;         ///< of the marginals of a window of mass 1 [-]
  double mean_violation = 0;          ///< over windows
  double mean_remaining = 0;          ///< mass without counterpart within reach, over windows [-]
};

inline void describe(const Transport_summary& summary, Orl_report& report)
{
  report.number_of_windows = summary.number_of_windows;
  report.number_of_failed_windows = summary.number_of_failures;
  report.worst_marginal_violation = summary.worst_violation;
  report.untransported_mass_share = summary.mean_remaining;
  report.mean_marginal_violation = summary.mean_violation;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_POINT_PAIR_H
