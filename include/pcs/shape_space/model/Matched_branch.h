// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A pair of corresponding branches.

#ifndef PCS_SHAPE_SPACE_MODEL_MATCHED_BRANCH_H
#define PCS_SHAPE_SPACE_MODEL_MATCHED_BRANCH_H

#include <pcs/shape_space/model/Branch_paths.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace pcs {
namespace shape_space {

/// Two corresponding branches, and the pairs of their children.
struct Matched_branch
{
  std::size_t path_1 = none, path_2 = none;
  std::array<std::size_t, 2> last = {none, none}; ///< node at which the pair ends, on each path
  double cost = 0;                                ///< including their subtrees [-]
  Eigen::Matrix3d rotation =
      Eigen::Matrix3d::Identity(); ///< aligns the second branch with the first
  struct Pair
  {
    std::size_t child_1, child_2; ///< positions in `Branch_path::children`
    std::shared_ptr<const Matched_branch> branch;
  };
  std::vector<Pair> pairs; ///< by child_1
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_MATCHED_BRANCH_H
