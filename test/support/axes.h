// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axes of branches for tests of the skeleton's stages.

#ifndef PCS_TEST_SUPPORT_AXES_H
#define PCS_TEST_SUPPORT_AXES_H

#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <vector>

namespace pcs_test {

/// A straight axis of equal steps, with linearly changing radii.
inline pcs::skeleton::Axis straight_axis(const pcs::skeleton::Vec3& from,
                                         const pcs::skeleton::Vec3& to,
                                         std::size_t steps,
                                         double first_radius,
                                         double last_radius)
{
  pcs::skeleton::Axis axis;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double t = double(k) / double(steps);
    pcs::skeleton::Axis_node node;
    node.point = from + t * (to - from);
    node.radius = first_radius + t * (last_radius - first_radius);
    axis.push_back(node);
  }
  return axis;
}

/// Adds a measured branch on the node `seat`, or the trunk; returns its index.
inline pcs::skeleton::Index add_branch(pcs::skeleton::Branch_tree& tree,
                                       pcs::skeleton::Index seat,
                                       const pcs::skeleton::Axis& axis)
{
  using namespace pcs::skeleton;
  const Index b = static_cast<Index>(tree.branches.size());
  Branch branch;
  if (seat != none) {
    branch.parent = tree.nodes[seat].branch;
    branch.order = tree.branches[branch.parent].order + 1;
  }
  Index before = seat;
  for (const Axis_node& place : axis) {
    Branch_node node;
    static_cast<Axis_node&>(node) = place;
    node.is_measured = true;
    node.parent = before;
    node.branch = b;
    before = static_cast<Index>(tree.nodes.size());
    branch.nodes.push_back(before);
    tree.nodes.push_back(node);
  }
  tree.branches.push_back(branch);
  return b;
}

/// Assigns the input points of a scan to existing axes of a set, or to none.
inline void assign_points(const pcs::skeleton::Scan& scan,
                          const std::vector<pcs::skeleton::Index>& axis_of_input,
                          pcs::skeleton::Axis_set& set)
{
  using namespace pcs::skeleton;
  set.axis_of_point.assign(scan.size(), none);
  set.segment_of_point.assign(scan.size(), none);
  for (std::size_t k = 0; k < axis_of_input.size(); ++k) {
    if (axis_of_input[k] == none)
      continue;
    const Index i = scan.point_of_input[k];
    Fitted_axis& axis = set.axes[axis_of_input[k]];
    ++axis.number_of_points;
    set.axis_of_point[i] = axis_of_input[k];
    set.segment_of_point[i] = nearest_place(axis.axis, scan.points[i]).segment;
  }
}

/// One point per segment of each axis.
inline pcs::skeleton::Axis_set set_of(const std::vector<pcs::skeleton::Axis>& axes)
{
  using pcs::skeleton::Index;
  pcs::skeleton::Axis_set set;
  for (const pcs::skeleton::Axis& axis : axes) {
    for (Index s = 0; s + 1 < axis.size(); ++s) {
      set.axis_of_point.push_back(static_cast<Index>(set.axes.size()));
      set.segment_of_point.push_back(s);
    }
    set.axes.push_back({axis, pcs::skeleton::none, axis.size() - 1, 1});
  }
  return set;
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_AXES_H
