// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How new trees are drawn.

#ifndef PCS_SHAPE_SPACE_SAMPLING_OPTIONS_H
#define PCS_SHAPE_SPACE_SAMPLING_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace shape_space {

/// How new trees are drawn.
struct Sampling_options
{
  double truncation = 2.5; ///< no score is further from 0, in standard deviations [-]
  double spread = 1;       ///< factor of all standard deviations; 0 gives middle trees only [-]
  /// share of the variance that is drawn for each branch by itself, and not for all branches together as they vary in the
  /// inputs, in [0, 1]; negative: as estimated from the inputs
  double shrinkage = -1;
  bool do_draw_presence = true; ///< else all trees have the branches that most of the inputs have
  /// whether trees keep to the range of the inputs: branches sit on those parts of others where they do in the inputs,
  /// numbers and angles of branches of an order are brought into their range by the least change, and trees that are beyond
  /// them in other figures are drawn again
  bool do_keep_in_range = true;
  std::size_t number_of_trials =
      100; ///< for that; from the middle on, nearer and nearer to the middle tree
  bool do_limit_radii = false; ///< no branch thicker than where it grows from
  double pipe_exponent =
      0; ///< > 0: radii to this power do not add up to more than that of the parent; 2 to 2.5 in nature
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_SAMPLING_OPTIONS_H
