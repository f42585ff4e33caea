// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branches that correspond, and the weights of the energy that decides.

#ifndef PCS_SHAPE_SPACE_MATCHED_BRANCH_H
#define PCS_SHAPE_SPACE_MATCHED_BRANCH_H

#include <pcs/shape_space/Branch_paths.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace pcs {
namespace shape_space {

/// How branches of a tree become longer.
enum class Growth {
  any,            ///< along branches, unless growth at tips explains clearly more
  along_branches, ///< everywhere: a branch is stretched, and what hangs on it moves along
  at_tips ///< what is there stays; the two trees are measured in the same unit, and the shorter of two branches is the
          ///< beginning of the longer one
};

/// Weights of the energy of a matching. All terms are lengths in units of the longest path of each tree, so
/// that size does not matter.
struct Matching_weights
{
  Growth growth = Growth::any; ///< for two trees; spaces of more stretch branches
  double curve = 1;            ///< of the elastic energy of two branches [-]
  double position = 1;  ///< of the distance of attachments, in units of the branches' lengths [-]
  double far = 1;       ///< attachments so far apart, of the parent's length, cost half of that [-]
  double single = 0.5;  ///< of the length of a subtree without partner [-]
  double length = 1;    ///< of a difference of lengths, in units of `single` [-]
  double turn = 0.2;    ///< of the turn of a branch against its parents [-]
  double children = 1;  ///< of the children's shares in the turn that is carried on [-]
  double carried = 0.1; ///< of the parents' turn in that of their children [-]
  bool is_carried = true; ///< whether turns of parents are carried to their children
  bool is_published =
      false; ///< the text's energy: no turns, `single` is 1, positions in units of the parent's length
  double fork_ratio = default_fork_ratio;       ///< see `Branch_paths`
  double trunk_fork_ratio = default_fork_ratio; ///< the same for the trunk, if it is less
  std::size_t number_of_paths = 6; ///< candidates for the main path of a branch; 1: the longest
  std::size_t number_of_trials =
      3; ///< pairs of candidates that are matched with all their children
};

/// Two branches that correspond, and what hangs on them.
struct Matched_branch
{
  std::size_t path_1 = none, path_2 = none;
  std::array<std::size_t, 2> last = {none, none}; ///< node of each path that the pair ends with
  double cost = 0;                                ///< with all that hangs on them [-]
  Eigen::Matrix3d rotation =
      Eigen::Matrix3d::Identity(); ///< carries the second branch to the first
  struct Pair
  {
    std::size_t child_1, child_2; ///< positions in `Branch_path::children`
    std::shared_ptr<const Matched_branch> branch;
  };
  std::vector<Pair> pairs; ///< by child_1
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHED_BRANCH_H
