// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Common elliptic section of branches whose single sections do not determine ellipses, since they
// are visible from one side only or nearly round.

#ifndef PCS_SKELETON_RADII_FIT_BRANCH_OVALS_H
#define PCS_SKELETON_RADII_FIT_BRANCH_OVALS_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/axes/Axis_fit.h>
#include <pcs/skeleton/axes/Axis_oval.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Index_groups.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for the common oval of a branch.
struct Branch_oval_options
{
  Oval_options oval;       ///< of the estimator; also the thinnest branch
  double significance = 4; ///< least difference from a circle, in standard errors [-]
};

namespace internal {

/// Returns the oval of a branch with a given axis; a circle if it is thin or has too few points.
inline Axis_oval oval_of_branch(const Scan& scan,
                                double noise,
                                const Axis& axis,
                                const std::vector<Vec3>& points,
                                std::vector<Index> segments,
                                const Branch_oval_options& rules)
{
  Axis_oval oval(axis);
  std::vector<double> radii;
  for (const Axis_node& node : axis)
    radii.push_back(node.radius);
  if (points.size() < rules.oval.count ||
      pcs::internal::lower_median(radii) <
          std::max(rules.oval.thickness * noise, rules.oval.spacings * scan.spacing))
    return oval;
  Axis_fit fit(axis, Fit_model::of(scan.spacing, noise));
  fit.set_points(points, std::move(segments));
  fit.project();
  oval.improve(fit, noise, rules.oval);
  return oval;
}

} // namespace internal

/*!
  Fits one oval `r (1 + c cos 2a + s sin 2a)` to all sections of a branch if at least half of its
  nodes are measured and have no ellipse, since the points of a single section are an arc. These
  nodes get an ellipse of the shape of the oval, with the area of their circle. If the oval does not
  significantly differ from a circle, they remain circles. O(points).
*/
template <class ConcurrencyTag>
void fit_branch_ovals(const Scan& scan,
                      double noise,
                      const Branch_oval_options& rules,
                      Branch_tree& tree)
{
  const Index_groups points_of_node(tree.nodes.size(), tree.node_of_point);
  pcs::internal::for_each_index<ConcurrencyTag>(tree.branches.size(), [&](std::size_t b) {
    const std::vector<Index>& nodes = tree.branches[b].nodes; // the first lies on the parent's axis
    Axis axis;
    std::vector<Index> node_of;
    std::vector<Vec3> points;
    std::vector<Index> segments;
    std::size_t number_of_round = 0;
    for (std::size_t k = tree.is_base(nodes[0]) ? 1 : 0; k < nodes.size(); ++k) {
      const Branch_node& node = tree.nodes[nodes[k]];
      if (!axis.empty() && !((node.point - axis.back().point).norm() > 0))
        continue;
      for (const Index i : points_of_node[nodes[k]]) {
        points.push_back(scan.points[i]);
        segments.push_back(static_cast<Index>(axis.empty() ? 0 : axis.size() - 1));
      }
      axis.push_back(node);
      node_of.push_back(nodes[k]);
      number_of_round += node.is_measured && !(node.major_radius > 0);
    }
    if (axis.size() < 2 || 2 * number_of_round < axis.size())
      return;
    const Axis_oval oval =
        internal::oval_of_branch(scan, noise, axis, points, std::move(segments), rules);
    const double size = oval.coefficients().norm();
    if (!(size > rules.significance * oval.error()))
      return;
    for (std::size_t k = 0; k < node_of.size(); ++k) {
      Branch_node& node = tree.nodes[node_of[k]];
      if (!node.is_measured || node.major_radius > 0)
        continue;
      node.set_ellipse((1 + size) / (1 - size),
                       oval.longest_direction(k + 1 < node_of.size() ? k : k - 1));
    }
  });
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_FIT_BRANCH_OVALS_H
