// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks of the options of correspondences.

#ifndef PCS_SHAPE_SPACE_INPUT_CHECK_OPTIONS_H
#define PCS_SHAPE_SPACE_INPUT_CHECK_OPTIONS_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/errors.h>
#include <pcs/shape_space/model/Matched_branch.h>

#include <cmath>
#include <string>

namespace pcs {
namespace shape_space {

/// Throws `pcs::Invalid_input` with a message that begins with `caller`.
inline void check_options(const Matching_weights& w,
                          const Point_assignment_options& a,
                          const Transport_options& t,
                          const std::string& caller)
{
  const auto check = [&](bool is_right, const char* what) {
    if (!is_right)
      throw Invalid_input(caller + ": " + what);
  };
  const auto is_weight = [](double x) { return x >= 0 && std::isfinite(x); };
  check(w.curve > 0 && std::isfinite(w.curve), "the weight `curve` must be > 0 and finite");
  check(is_weight(w.position) && is_weight(w.unmatched) && is_weight(w.children) &&
            is_weight(w.inherited_rotation) && is_weight(w.rotation) && is_weight(w.length),
        "the weights of the matching must be >= 0 and finite");
  check(w.half_cost_distance > 0 && std::isfinite(w.half_cost_distance),
        "`half_cost_distance` must be > 0 and finite");
  check(w.fork_ratio > 0 && w.fork_ratio <= 1, "`fork_ratio` must be in (0, 1]");
  check(w.trunk_fork_ratio > 0 && w.trunk_fork_ratio <= 1, "`trunk_fork_ratio` must be in (0, 1]");
  check(w.number_of_paths > 0 && w.number_of_trials > 0,
        "`number_of_paths` and `number_of_trials` must be at least 1");
  check(is_weight(a.noise) && a.normal_angle > 0, "`noise` must be >= 0, `normal_angle` > 0");
  check(a.number_of_neighbors >= 3, "`number_of_neighbors` of the assignment must be >= 3");
  check(t.number_of_neighbors > 0 && t.largest_window > 0,
        "`number_of_neighbors` and `largest_window` of the transport must be at least 1");
  check(t.reach > 0, "`reach` must be > 0");
  check(t.sinkhorn.regularization > 0 && t.sinkhorn.regularization <= 1,
        "`regularization` must be in (0, 1]");
  check(t.sinkhorn.iterations > 0, "`iterations` must be > 0");
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_CHECK_OPTIONS_H
