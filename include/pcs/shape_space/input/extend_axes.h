// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Extension of skeletons to the ends of their scans.

#ifndef PCS_SHAPE_SPACE_INPUT_EXTEND_AXES_H
#define PCS_SHAPE_SPACE_INPUT_EXTEND_AXES_H

#include <pcs/core/Tree_skeleton.h>
#include <pcs/internal/median.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/shape_space/model/Rooted_tree.h>

#include <CGAL/number_utils.h>

#include <boost/range/iterator_range.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Returns the vector from `end` to the end of the points beyond it; null if the points extend no
/// farther along the axis than across. [L]
inline Vec3 extension(const Vec3& end, double radius, const std::vector<Vec3>& points)
{
  constexpr std::size_t least_number = 8;
  constexpr double fraction = 0.98, rounded_end = 2; // in units of the radius
  if (points.size() < least_number)
    return Vec3::Zero();
  Vec3 direction = Vec3::Zero();
  for (const Vec3& p : points)
    direction += p - end;
  if (!(direction.norm() > 0))
    return Vec3::Zero();
  direction.normalize();
  std::vector<double> reach;
  double sideways = 0;
  for (const Vec3& p : points) {
    reach.push_back((p - end).dot(direction));
    sideways += ((p - end) - reach.back() * direction).squaredNorm();
  }
  const double last = pcs::internal::value_of_rank(
      reach,
      static_cast<std::size_t>(fraction * static_cast<double>(reach.size() - 1)));
  const double width = std::max(radius, std::sqrt(sideways / static_cast<double>(reach.size())));
  if (!(last > rounded_end * width))
    return Vec3::Zero();
  return last * direction;
}

/// Positions along all axes of a tree; some of them are ends of axes.
struct Axis_samples
{
  std::vector<Vec3> positions;
  std::vector<std::size_t> end; ///< for each position: node of the end, or `npos`
  std::vector<Vec3> outward;    ///< for each node: direction of the axis at an end
};

/// Samples the axes of a tree at distances of `step` or less. `nodes`: positions of the nodes. [L]
template <class Kernel>
Axis_samples
sample_axes(const Tree_skeleton<Kernel>& tree, const std::vector<Vec3>& nodes, double step)
{
  const std::size_t root = tree[boost::graph_bundle].root;
  Axis_samples result;
  result.positions.push_back(nodes[root]);
  result.outward.assign(nodes.size(), Vec3::Zero());
  result.end.push_back(out_degree(root, tree) == 1 ? root : npos);
  for (const auto e : boost::make_iterator_range(edges(tree))) {
    const std::size_t u = source(e, tree), v = target(e, tree);
    const Vec3 axis = nodes[v] - nodes[u];
    const double pieces = std::ceil(axis.norm() / step);
    if (!(pieces > 0))
      continue;
    for (double k = 1; k <= pieces; ++k) {
      result.positions.push_back(nodes[u] + k / pieces * axis);
      result.end.push_back(k == pieces && out_degree(v, tree) == 0 ? v : npos);
    }
    result.outward[v] = axis;
    if (u == root)
      result.outward[u] = -axis;
  }
  return result;
}

template <class Point>
Vec3 position_of(const Point& p)
{
  return Vec3(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
}

/// Collects, for each end, the points beyond the end that are nearer to it than to other samples.
template <class PointRange>
std::vector<std::vector<Vec3>> points_beyond_ends(const PointRange& scan,
                                                  const Vec3& origin,
                                                  const std::vector<Vec3>& nodes,
                                                  const Axis_samples& samples)
{
  const neighborhood::Nearest_neighbors search(samples.positions);
  std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
  std::vector<std::vector<Vec3>> result(nodes.size());
  for (const auto& point : scan) {
    const Vec3 p = position_of(point) - origin;
    if (!is_place(p))
      continue;
    search(p, 1, found);
    const std::size_t v = samples.end[found[0].index];
    if (v != npos && (p - nodes[v]).dot(samples.outward[v]) > 0)
      result[v].push_back(p);
  }
  return result;
}

} // namespace internal

/*!
  Moves the tips of a tree, and its root if only one branch begins there, to the ends of the points
  of its scan. Returns the number of moved nodes.

  The length of a branch is the length of its axis. If axes reach the tips of leaves in one scan but
  not in another, leaves seem to shrink. The extension is estimated from the points that lie beyond
  an end and are nearest to it. There must be at least eight such points, which extend farther along
  the axis than across. \f$O(n \log m)\f$ for n points and m nodes.
*/
template <class Kernel, class PointRange>
std::size_t extend_axes(Tree_skeleton<Kernel>& tree, const PointRange& scan)
{
  constexpr double samples_per_edge = 16;
  const auto n = static_cast<std::size_t>(num_vertices(tree));
  const std::size_t root = tree[boost::graph_bundle].root;
  if (root >= n || num_edges(tree) == 0)
    return 0;
  const Vec3 origin = internal::position_of(tree[root].point);
  std::vector<Vec3> nodes;
  for (std::size_t v = 0; v < n; ++v)
    nodes.push_back(internal::position_of(tree[v].point) - origin);
  double total = 0;
  for (const auto e : boost::make_iterator_range(edges(tree)))
    total += (nodes[target(e, tree)] - nodes[source(e, tree)]).norm();
  if (!(total > 0) || !is_length(total))
    return 0;
  const double step = total / (samples_per_edge * static_cast<double>(num_edges(tree)));
  const internal::Axis_samples samples = internal::sample_axes(tree, nodes, step);
  const std::vector<std::vector<Vec3>> beyond =
      internal::points_beyond_ends(scan, origin, nodes, samples);
  std::size_t number_moved = 0;
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3 extension =
        internal::extension(nodes[v], CGAL::to_double(tree[v].radius), beyond[v]);
    if (extension.isZero(0))
      continue;
    const Vec3 to = origin + nodes[v] + extension;
    tree[v].point = typename Kernel::Point_3(to.x(), to.y(), to.z());
    ++number_moved;
  }
  return number_moved;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_EXTEND_AXES_H
