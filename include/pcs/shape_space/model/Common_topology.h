// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Common topology of two trees, with the counterpart of every node.

#ifndef PCS_SHAPE_SPACE_MODEL_COMMON_TOPOLOGY_H
#define PCS_SHAPE_SPACE_MODEL_COMMON_TOPOLOGY_H

#include <pcs/shape_space/model/Branch_paths.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

/// A branch of the common topology. Its nodes lie at fractions of the length of either branch,
/// increasing from 0 to 1.
struct Common_branch
{
  std::size_t parent = none;                      ///< index of an earlier branch, or `none`
  std::array<std::size_t, 2> path = {none, none}; ///< of each tree, `none`: virtual
  std::array<std::vector<double>, 2>
      node; ///< both of the same size, at least 2; empty for a virtual branch
  std::array<double, 2> attachment = {
      0,
      0}; ///< on the parent: number of a node, plus the fraction of the next edge
  /// of the correspondence of both branches, see `Match_confidences`; NaN if it is not known, or
  /// the branch is virtual in a tree [-]
  double confidence = std::numeric_limits<double>::quiet_NaN();
  std::size_t number_of_nodes() const { return std::max(node[0].size(), node[1].size()); }
  bool is_virtual(int tree) const { return path[static_cast<std::size_t>(tree)] == none; }
};

struct Common_topology
{
  std::vector<Common_branch> branches; ///< parents first
  std::array<Branch_paths, 2> paths;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_COMMON_TOPOLOGY_H
