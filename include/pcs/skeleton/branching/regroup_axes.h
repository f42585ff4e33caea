// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branches of a tree as new axes, for another round of joining.

#ifndef PCS_SKELETON_BRANCHING_REGROUP_AXES_H
#define PCS_SKELETON_BRANCHING_REGROUP_AXES_H

#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  Replaces the axes that were joined to `tree` by the branches of `tree`. Omits the first node of a
  branch, which lies on the axis of the parent. A fitted axis may change from one branch to another,
  whereas the tree continues straight, so that its branches are more reliable. Unreachable axes
  remain. Every point keeps an axis. O(nodes + points).
*/
inline void regroup_axes(const Branch_tree& tree, Axis_set& set)
{
  if (tree.branches.empty() || tree.branches.front().nodes.size() < 2)
    return; // the root is a single node
  std::vector<Fitted_axis> axes;
  std::vector<Index> axis_of_branch(tree.branches.size(), none);
  std::vector<Index> place(tree.nodes.size(), 0); // index of a node on its axis
  for (Index b = 0; b < tree.branches.size(); ++b) {
    const Branch& branch = tree.branches[b];
    const Index seat = tree.nodes[branch.nodes.front()].parent;
    if (branch.nodes.size() < 2) { // lies entirely on its parent
      axis_of_branch[b] = axis_of_branch[branch.parent];
      place[branch.nodes.front()] = place[seat];
      continue;
    }
    const std::size_t first = seat != none && branch.nodes.size() > 2 ? 1 : 0;
    Fitted_axis axis;
    for (std::size_t k = 0; k < branch.nodes.size(); ++k) {
      place[branch.nodes[k]] = static_cast<Index>(k > first ? k - first : 0);
      if (k >= first)
        axis.axis.push_back(tree.nodes[branch.nodes[k]]);
    }
    axis_of_branch[b] = static_cast<Index>(axes.size());
    axes.push_back(std::move(axis));
  }
  std::vector<Index> out_of_reach(set.axes.size(), none); // new indices of unreachable axes
  for (std::size_t i = 0; i < set.axis_of_point.size(); ++i) {
    Index& axis = set.axis_of_point[i];
    if (axis == none)
      continue;
    const Index v = tree.node_of_point[i];
    if (v != none) {
      axis = axis_of_branch[tree.nodes[v].branch];
      set.segment_of_point[i] = std::min(place[v], static_cast<Index>(axes[axis].axis.size() - 2));
    } else {
      Index& number = out_of_reach[axis];
      if (number == none) {
        number = static_cast<Index>(axes.size());
        axes.push_back(std::move(set.axes[axis]));
        axes.back().number_of_points = 0;
        axes.back().parent = none; // it refers to the previous axes
      }
      axis = number;
    }
    ++axes[axis].number_of_points;
  }
  set.axes = std::move(axes);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_REGROUP_AXES_H
