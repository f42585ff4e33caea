// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks that a skeleton can be read as a sample of a habit.

#ifndef PCS_GENERATORS_HABIT_CHECK_TREE_H
#define PCS_GENERATORS_HABIT_CHECK_TREE_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/generators/habit/Tree_sample.h>

#include <CGAL/number_utils.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/// Throws `Invalid_input` with a message that begins with `where`, unless each node has one parent
/// at most, a branch that exists, and finite values.
template <class Tree>
void check_nodes(const Tree& tree, const std::string& where)
{
  const auto& bundle = tree[boost::graph_bundle];
  if (num_vertices(tree) == 0 || bundle.root >= num_vertices(tree))
    throw Invalid_input(where + " has no nodes or no root");
  if (in_degree(bundle.root, tree) != 0)
    throw Invalid_input(where + ": its root has a parent; the root must be the lowest node");
  for (std::size_t v = 0; v < num_vertices(tree); ++v) {
    const auto& node = tree[v];
    const std::string name = where + ", node " + std::to_string(v);
    if (node.branch >= bundle.branches.size())
      throw Invalid_input(name + " is of branch " + std::to_string(node.branch) +
                          ", which does not exist; call pcs::assign_branches()");
    if (in_degree(v, tree) > 1)
      throw Invalid_input(name + " has more than one parent");
    for (const double value : {CGAL::to_double(node.point.x()),
                               CGAL::to_double(node.point.y()),
                               CGAL::to_double(node.point.z()),
                               CGAL::to_double(node.radius),
                               CGAL::to_double(node.radius_error)})
      if (!std::isfinite(value))
        throw Invalid_input(name + " has a coordinate or radius that is not finite");
  }
}

/// Reads a tree. Throws `Invalid_input`, with a message that begins with `where`, unless it has a
/// trunk and four more branches.
template <class Tree>
Tree_sample checked_sample(const Tree& tree, double smallest_radius, const std::string& where)
{
  constexpr std::size_t fewest_axes = 5;
  check_nodes(tree, where);
  Tree_sample sample = read_sample(tree, smallest_radius);
  if (sample.axes.size() < fewest_axes) {
    std::string rule = where + " has " + std::to_string(sample.axes.size()) + " branches";
    if (smallest_radius > 0)
      rule += " that are not thinner than `smallest_radius`";
    throw Invalid_input(rule + "; a habit needs a trunk and at least " +
                        std::to_string(fewest_axes - 1) + " branches");
  }
  return sample;
}

/// Returns the angle between z and the line from the base of the trunk to its tip. [rad]
inline double trunk_tilt(const Tree_sample& sample)
{
  const std::vector<Vector3>& points = sample.axes.front().points;
  const Vector3 line = points.back() - points.front();
  return std::atan2(line.head<2>().norm(), line.z());
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_CHECK_TREE_H
