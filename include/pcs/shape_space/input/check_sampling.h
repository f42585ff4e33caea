// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks of the options of sampling and of tree weights.

#ifndef PCS_SHAPE_SPACE_INPUT_CHECK_SAMPLING_H
#define PCS_SHAPE_SPACE_INPUT_CHECK_SAMPLING_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace shape_space {

/// Throws `pcs::Invalid_input` with a message that begins with `caller`.
inline void check_sampling(const Tree_sampling_options& o, const std::string& caller)
{
  const auto check = [&](bool is_right, const char* what) {
    if (!is_right)
      throw Invalid_input(caller + ": " + what);
  };
  check(o.truncation > 0, "`truncation` must be > 0");
  check(o.spread >= 0 && std::isfinite(o.spread), "`spread` must be >= 0 and finite");
  check(o.shrinkage <= 1, "`shrinkage` must be at most 1");
  check(o.number_of_trials > 0, "`number_of_trials` must be at least 1");
  check(o.pipe_exponent >= 0 && std::isfinite(o.pipe_exponent),
        "`pipe_exponent` must be >= 0 and finite");
}

/// Checks that there is one weight per tree, with a positive sum. Throws like `check_sampling()`.
inline void check_tree_weights(const std::vector<double>& w,
                               std::size_t number_of_trees,
                               bool may_be_negative,
                               const std::string& caller)
{
  if (w.size() != number_of_trees)
    throw Invalid_input(caller + ": " + std::to_string(w.size()) + " weights for " +
                        std::to_string(number_of_trees) + " trees");
  double total = 0, size = 0;
  for (const double x : w) {
    if (!std::isfinite(x) || (x < 0 && !may_be_negative))
      throw Invalid_input(
          caller + ": a weight is " + pcs::internal::to_text(x) +
          (may_be_negative ? ", expected finite numbers" : ", expected numbers >= 0"));
    total += x;
    size += std::abs(x);
  }
  if (!std::isfinite(size))
    throw Invalid_input(caller + ": the weights are too large: their sum is not finite");
  if (!(total > 1e-9 * size))
    throw Invalid_input(caller + ": the sum of the weights must be positive");
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_CHECK_SAMPLING_H
