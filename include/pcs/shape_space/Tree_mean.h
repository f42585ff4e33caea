// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Which mean of trees.

#ifndef PCS_SHAPE_SPACE_TREE_MEAN_H
#define PCS_SHAPE_SPACE_TREE_MEAN_H

namespace pcs {
namespace shape_space {

/// What a mean makes least.
enum class Tree_mean {
  least_sum,    ///< of distances, (4.16): medians; trees unlike all others have no say
  least_squares ///< of squared distances, each coordinate apart
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TREE_MEAN_H
