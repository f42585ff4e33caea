// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Count of further stems at the height of the root.

#ifndef PCS_SKELETON_RESULT_COUNT_OTHER_STEMS_H
#define PCS_SKELETON_RESULT_COUNT_OTHER_STEMS_H

#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Joint.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for a stem. Lengths are fractions of the height of the tree [-].
struct Stem_options
{
  double foot = 0.15;   ///< highest foot above the root
  double length = 0.25; ///< least rise
  double steep = 0.5;   ///< least rise per length [-]
  double taper =
      1.2; ///< least ratio of the lower radius to the upper radius or to the base radius [-]
};

namespace internal {

/// The lower and the upper end of a sequence of nodes.
struct Axis_slope_summary
{
  double foot = 0, rise = 0, length = 0; ///< [L]
  double lower_radius = 0, upper_radius = 0;

  /// `node_at(k)` returns node k of n; z points upwards.
  template <class NodeAt>
  Axis_slope_summary(std::size_t n, const NodeAt& node_at)
  {
    const std::size_t third = std::max<std::size_t>(1, n / 3);
    const bool is_upward = node_at(0).point.z() <= node_at(n - 1).point.z();
    double first = 0, last = 0;
    for (std::size_t k = 0; k < third; ++k) {
      first += node_at(k).radius / double(third);
      last += node_at(n - 1 - k).radius / double(third);
    }
    for (std::size_t k = 1; k < n; ++k)
      length += (node_at(k).point - node_at(k - 1).point).norm();
    foot = std::min(node_at(0).point.z(), node_at(n - 1).point.z());
    rise = std::abs(node_at(n - 1).point.z() - node_at(0).point.z());
    lower_radius = is_upward ? first : last;
    upper_radius = is_upward ? last : first;
  }

  bool is_stem(double ground, double height, const Stem_options& rules) const
  {
    return foot <= ground + rules.foot * height && rise >= rules.length * height &&
           rise >= rules.steep * length;
  }
};

} // namespace internal

/*!
  Counts further stems that begin near the height of the root. They are unreachable axes, and
  branches that descend to this height and are thicker at their lower end. Such a branch is the stem
  of another tree, joined to this one where the crowns touch. z points upwards. O(nodes).
*/
inline std::size_t count_other_stems(const Axis_set& set,
                                     const std::vector<Joint>& joints,
                                     Index root,
                                     const Branch_tree& tree,
                                     const Stem_options& rules)
{
  if (tree.nodes.empty())
    return 0;
  const double ground = tree.nodes[0].point.z();
  double height = 0;
  for (const Branch_node& node : tree.nodes)
    height = std::max(height, node.point.z() - ground);
  std::size_t count = 0;
  for (Index a = 0; a < set.axes.size(); ++a) {
    const Axis& axis = set.axes[a].axis;
    if (a == root || joints[a].parent != none)
      continue;
    const internal::Axis_slope_summary standing(
        axis.size(),
        [&](std::size_t k) -> const Axis_node& { return axis[k]; });
    count += standing.is_stem(ground, height, rules);
  }
  for (std::size_t b = 1; b < tree.branches.size(); ++b) {
    const std::vector<Index>& nodes = tree.branches[b].nodes;
    const auto z = [&](std::size_t k) { return tree.nodes[nodes[k]].point.z(); };
    std::size_t low = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k)
      low = z(k) <= z(low) ? k : low;
    // from the lowest node back to the highest one, up to a descent by the largest height of a foot
    std::size_t top = low;
    for (std::size_t k = low; k-- > 0 && z(k) >= z(top) - rules.foot * height;)
      top = z(k) > z(top) ? k : top;
    const auto node_at = [&](std::size_t k) -> const Axis_node& {
      return tree.nodes[nodes[top + k]];
    };
    const internal::Axis_slope_summary standing(low + 1 - top, node_at);
    // a branch becomes thinner towards its tip; an inverted stem is thicker at its lower end than
    // at its upper end, or than the branch that leads to it
    const double base = tree.nodes[nodes[std::min<std::size_t>(1, nodes.size() - 1)]].radius;
    count += standing.is_stem(ground, height, rules) &&
             standing.lower_radius >= rules.taper * std::min(base, standing.upper_radius);
  }
  return count;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESULT_COUNT_OTHER_STEMS_H
