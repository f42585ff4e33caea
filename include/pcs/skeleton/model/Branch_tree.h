// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rooted tree of nodes, grouped into branches.

#ifndef PCS_SKELETON_MODEL_BRANCH_TREE_H
#define PCS_SKELETON_MODEL_BRANCH_TREE_H

#include <pcs/skeleton/model/Axis.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Node of the result. Parents have smaller indices than their children.
struct Branch_node : Axis_node
{
  Index parent = none;
  Index branch = none;
  double major_radius = 0, minor_radius = 0; ///< of the section; 0: a circle [L]
  Vec3 major_axis = Vec3::Zero();

  /// Makes the section an ellipse with the same area. `ratio` of the semi-axes is at least 1.
  void set_ellipse(double ratio, const Vec3& longest_direction)
  {
    major_radius = radius * std::sqrt(ratio);
    minor_radius = radius / std::sqrt(ratio);
    major_axis = longest_direction;
  }

  /// Scales the section without changing its shape.
  void resize(double new_radius)
  {
    if (radius > 0) {
      major_radius *= new_radius / radius;
      minor_radius *= new_radius / radius;
    }
    radius = new_radius;
  }
};

struct Branch
{
  Index parent = none; ///< parent branch
  int order = 0;
  std::vector<Index> nodes; ///< the first lies on the axis of the parent
};

struct Branch_tree
{
  std::vector<Branch_node> nodes;
  std::vector<Branch> branches;     ///< parents before their children
  std::vector<Index> node_of_point; ///< per point of the scan; `none`: not explained
  std::size_t number_of_unreached_axes = 0;

  /// Returns whether `v` is the base of its branch, so that its edge leads to another branch.
  bool is_base(Index v) const
  {
    return nodes[v].parent == none || nodes[nodes[v].parent].branch != nodes[v].branch;
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_BRANCH_TREE_H
