// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Initial axis of a chain from the centers of its level-set components.

#ifndef PCS_SKELETON_AXES_CHAIN_START_H
#define PCS_SKELETON_AXES_CHAIN_START_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/axes/decompose_chains.h>
#include <pcs/skeleton/model/Layer_tree.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Initial axis of a chain, and the points of the chain that no axis explains yet.
struct Chain_start
{
  Axis axis;
  std::vector<Index> points;
  std::vector<std::size_t> place; ///< node of `axis` for each point
};

namespace internal {

/// Replaces the single node of a chain by a segment along the principal direction of its points.
/// The length of the segment is the thickness of a level set.
inline void
make_line(const Chain_view& view, const Layer_tree& tree, const Chain& chain, Chain_start& start)
{
  Axis& axis = start.axis;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Index i : start.points) {
    const Vec3 d = view.scan.points[i] - axis[0].point;
    covariance += d * d.transpose();
  }
  const auto eigen = linear_algebra::symmetric_eigen<3>(covariance);
  Vec3 along = eigen.vectors.col(2);
  const Vec3 from = chain.parent_node != none ? Vec3(axis[0].point - tree.center[chain.parent_node])
                                              : Vec3(Vec3::UnitZ());
  if (along.dot(from) < 0)
    along = -along;
  const double half = 0.5 * layer_thickness * view.scan.spacing;
  Axis_node tip = axis[0];
  axis[0].point -= half * along;
  tip.point += half * along;
  axis.push_back(tip);
  std::fill(start.place.begin(), start.place.end(), 0);
}

/// Smooths the centers, since level-set components are ragged, and extends both ends by half the
/// thickness of a level set.
inline void smooth_centers(double spacing, Axis& axis)
{
  for (int pass = 0; pass < 2; ++pass) {
    Axis smooth = axis;
    for (std::size_t k = 1; k + 1 < axis.size(); ++k)
      smooth[k].point = 0.25 * axis[k - 1].point + 0.5 * axis[k].point + 0.25 * axis[k + 1].point;
    axis = smooth;
  }
  const auto extend = [&](Axis_node& end, const Axis_node& inner) {
    const Vec3 d = end.point - inner.point;
    const double length = d.norm();
    if (length > 0)
      end.point += 0.5 * layer_thickness * spacing * d / length;
  };
  const Axis_node second = axis[1], last = axis[axis.size() - 2];
  extend(axis.front(), second);
  extend(axis.back(), last);
}

/// Initializes the radii by the root mean square distance of the points from the axis.
inline void guess_radii(const Scan& scan, Chain_start& start)
{
  Axis& axis = start.axis;
  const double u = scan.spacing;
  std::vector<double> sum(axis.size(), 0), count(axis.size(), 0);
  for (std::size_t i = 0; i < start.points.size(); ++i) {
    const std::size_t k = start.place[i];
    const Axis_place foot = nearest_place(axis, k, scan.points[start.points[i]]);
    sum[k] += foot.distance * foot.distance;
    count[k] += 1;
  }
  for (std::size_t k = 0; k < axis.size(); ++k)
    axis[k].radius = count[k] > 0 ? std::max(0.2 * u, std::sqrt(sum[k] / count[k]))
                                  : (k > 0 ? axis[k - 1].radius : 0.2 * u);
}

} // namespace internal

/// Initializes the fit of a chain: smoothed centers of the points of its level-set components that
/// no axis explains, with initial radii.
inline Chain_start start_of(const Chain_view& view, const Layer_tree& tree, const Chain& chain)
{
  Chain_start start;
  for (const Index v : chain.nodes) {
    Vec3 center = Vec3::Zero();
    const std::size_t before = start.points.size();
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
      if (!view.set.is_covered(tree.point[k])) {
        start.points.push_back(tree.point[k]);
        start.place.push_back(start.axis.size());
        center += view.scan.points[tree.point[k]];
      }
    if (start.points.size() == before)
      continue;
    Axis_node node;
    node.point = center / double(start.points.size() - before);
    start.axis.push_back(node);
  }
  if (start.points.size() < view.rules.lowest_count)
    return start;
  if (start.axis.size() == 1)
    internal::make_line(view, tree, chain, start);
  else
    internal::smooth_centers(view.scan.spacing, start.axis);
  internal::guess_radii(view.scan, start);
  return start;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_CHAIN_START_H
