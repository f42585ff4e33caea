// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removal of axes from a set, with new numbers for the others.

#ifndef PCS_SKELETON_AXES_REMOVE_AXES_H
#define PCS_SKELETON_AXES_REMOVE_AXES_H

#include <pcs/skeleton/model/Axis_set.h>

#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Removes the axes for which `is_removed(axis)` holds. Their points become unexplained, and their
/// children become children of their parents. O(axes + points) unless long chains of parents are
/// removed.
template <class IsRemoved>
void remove_axes(const IsRemoved& is_removed, Axis_set& set)
{
  std::vector<Index> number(set.axes.size(), none), new_parent(set.axes.size(), none); // new ones
  Index count = 0;
  for (Index a = 0; a < set.axes.size(); ++a)
    if (!is_removed(a))
      number[a] = count++;
  for (Index a = 0; a < set.axes.size(); ++a) {
    Index parent = set.axes[a].parent;
    for (Index step = 0; parent != none && number[parent] == none; ++step)
      parent = step < number.size() ? set.axes[parent].parent : none;
    new_parent[a] = parent != none && parent != a ? number[parent] : none;
  }
  std::vector<Fitted_axis> kept;
  kept.reserve(count);
  for (Index a = 0; a < set.axes.size(); ++a)
    if (number[a] != none) {
      set.axes[a].parent = new_parent[a];
      kept.push_back(std::move(set.axes[a]));
    }
  for (Index& a : set.axis_of_point)
    if (a != none)
      a = number[a];
  set.axes = std::move(kept);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_REMOVE_AXES_H
