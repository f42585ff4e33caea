// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What the report says of a tree: height, diameter at breast height, length and volume by order and by size, and its points.

#ifndef PCS_SKELETON_REPORT_SIZES_H
#define PCS_SKELETON_REPORT_SIZES_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/skeleton/Axis_set.h>
#include <pcs/skeleton/Branch_tree.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Upper bounds of the radius in the classes of the report, in breast heights: 5, 10, 20 and 50 mm in metres.
constexpr double size_bounds_by_breast_height[] = {0.005 / 1.3, 0.01 / 1.3, 0.02 / 1.3, 0.05 / 1.3};

/// Fills in what depends on the tree alone, in the unit of the input: `unit` times that of the tree. O(nodes).
inline void report_sizes(const Branch_tree& tree,
                         double unit,
                         const Vec3& up,
                         double breast_height,
                         Skeleton_report& r)
{
  r.breast_height = unit * breast_height;
  for (const double b : size_bounds_by_breast_height)
    r.size_bounds.push_back(unit * b * breast_height);
  r.by_size.resize(r.size_bounds.size() + 1);
  for (const Branch& b : tree.branches) {
    const std::size_t order = static_cast<std::size_t>(b.order);
    if (r.by_order.size() <= order)
      r.by_order.resize(order + 1);
    ++r.by_order[order].number_of_branches;
    ++r.total.number_of_branches;
  }
  if (tree.nodes.empty())
    return;
  const double ground = up.dot(tree.nodes[0].point);
  double thickest = 0; // of all that crosses breast height
  for (Index v = 0; v < tree.nodes.size(); ++v) {
    const Branch_node& node = tree.nodes[v];
    r.height = std::max(r.height, unit * (up.dot(node.point) - ground));
    if (tree.is_base(v))
      continue;
    const Branch_node& below = tree.nodes[node.parent];
    const double length = unit * (node.point - below.point).norm();
    const double a = unit * below.radius, b = unit * node.radius;
    const double volume = 3.14159265358979323846 / 3 * length * (a * a + a * b + b * b);
    std::size_t size = 0;
    while (size < r.size_bounds.size() && 0.5 * (a + b) > r.size_bounds[size])
      ++size;
    const std::size_t order = static_cast<std::size_t>(tree.branches[node.branch].order);
    for (Wood* w : {&r.total, &r.by_order[order], &r.by_size[size]}) {
      w->length += length;
      w->volume += volume;
    }
    const double h0 = up.dot(below.point) - ground - breast_height;
    const double h1 = up.dot(node.point) - ground - breast_height;
    if (h0 > 0 || h1 <= 0)
      continue;
    const double diameter = 2 * (a + (b - a) * h0 / (h0 - h1));
    if (order == 0 && r.diameter_at_breast_height == 0)
      r.diameter_at_breast_height = diameter;
    thickest = std::max(thickest, diameter);
  }
  if (r.diameter_at_breast_height == 0) // the trunk was lost below, among buttresses for example
    r.diameter_at_breast_height = thickest;
}

/// Counts the points that no axis explains, and those of axes that are not part of the tree. O(points).
inline void count_unexplained(const std::vector<std::uint8_t>& is_used,
                              const Axis_set& set,
                              const Branch_tree& tree,
                              Skeleton_report& r)
{
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i])
      continue;
    const bool has_node = !tree.node_of_point.empty() && tree.node_of_point[i] != none;
    const bool is_covered =
        has_node || (!set.axis_of_point.empty() && set.is_covered(static_cast<Index>(i)));
    r.number_of_unexplained_points += !is_covered;
    r.number_of_unreached_points += is_covered && !has_node;
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REPORT_SIZES_H
