// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The report of a finished tree: counts, sizes, residuals.

#ifndef PCS_SKELETON_RESULT_DESCRIBE_TREE_H
#define PCS_SKELETON_RESULT_DESCRIBE_TREE_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/core/Status.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/result/count_other_stems.h>
#include <pcs/skeleton/result/report_sizes.h>
#include <pcs/skeleton/result/residual_of_point.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Returns the height of the root above the lowest points for which `is_tree(i)` holds, without the
/// lowest 1/500 of them [L].
template <class IsTree>
double
elevation_of_root(const Scan& scan, const Branch_tree& tree, const Vec3& up, const IsTree& is_tree)
{
  std::vector<double> heights;
  for (Index i = 0; i < scan.size(); ++i)
    if (is_tree(i))
      heights.push_back(up.dot(scan.points[i]));
  if (heights.empty() || tree.nodes.empty())
    return 0;
  const double low = pcs::internal::value_of_rank(heights, heights.size() / 500);
  return std::max(0.0, up.dot(tree.nodes[0].point) - low);
}

/*!
  Fills in all entries that depend on the tree. `is_tree(i)` holds for the points of wood and
  leaves. `top_of_leaves` is the height of the highest leaves, in coordinates of the scan [L].
*/
template <class IsTree>
void describe_tree(const Scan& scan,
                   const std::vector<std::uint8_t>& is_used,
                   const IsTree& is_tree,
                   const Axis_set& axes,
                   const Branch_tree& tree,
                   const std::vector<Index>& successors,
                   const Vec3& up,
                   double breast_height,
                   double top_of_leaves,
                   Skeleton_report& r)
{
  const double unit = scan.frame.unit;
  r.status = tree.nodes.empty() ? Status::nothing_to_do : Status::converged;
  r.number_of_nodes = tree.nodes.size();
  r.number_of_branches = tree.branches.size();
  r.number_of_unreached_branches = tree.number_of_unreached_axes;
  count_unexplained(is_used, axes, tree, r);
  r.residual = unit * median_residual(scan, tree, successors);
  report_sizes(tree, unit, up, breast_height, r);
  if (!tree.nodes.empty())
    r.height = std::max(r.height, unit * (top_of_leaves - up.dot(tree.nodes[0].point)));
  r.estimates = pcs::internal::values_of_skeleton(r);
  r.root_elevation = unit * elevation_of_root(scan, tree, up, is_tree);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESULT_DESCRIBE_TREE_H
