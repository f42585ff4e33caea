// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axes of thinned scans, in which thick wood with few points is as dense as all other wood.

#ifndef PCS_SKELETON_CONTINUATION_FIND_COARSE_AXES_H
#define PCS_SKELETON_CONTINUATION_FIND_COARSE_AXES_H

#include <pcs/skeleton/axes/fit_axes.h>
#include <pcs/skeleton/graph/Neighbor_links.h>
#include <pcs/skeleton/layers/trace_layers.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for coarse axes, and for the places at which they replace fine ones.
struct Coarse_axis_options
{
  //! least distances of the points of the thinned scans, in spacings, in the order of use [-]
  std::vector<double> factors{4, 2};
  //! least radius, in spacings of the thinned scan [-]: then the axis is the middle of a tube
  double thinnest = 0.7;
  std::size_t window = 5;   ///< segments on both sides that count the points of a twig [count]
  double dense = 1.5;       ///< twigs with a point per this many spacings are left out [-]
  double reach = 1.5;       ///< distance up to which points are compared with an axis, in radii [-]
  std::size_t fewest = 8;   ///< least number of points on the surface of three segments [count]
  double on_surface = 0.85; ///< least fraction of the compared points there [-]
  double known = 0.5;       ///< largest fraction of these that similar axes explain [-]
  double shortest = 4;      ///< least length of a piece, in radii [-]
};

/// Axis of a thinned scan.
struct Coarse_axis
{
  Axis axis;
  double thinnest = 0; ///< radius below which the axis is not credible [L]
};

/// Returns which points of `is_used` may lie on wood that the axes of `set` miss: all but those of
/// twigs, thinner than `thinnest` [L], that have as many points as the scan has elsewhere. Strands
/// along the surface of thick wood have fewer. O(points + nodes).
inline std::vector<std::uint8_t> points_of_sparse_wood(const Scan& scan,
                                                       const std::vector<std::uint8_t>& is_used,
                                                       const Coarse_axis_options& rules,
                                                       double thinnest,
                                                       const Axis_set& set)
{
  std::vector<std::vector<double>> count(set.axes.size()); // points of each segment
  for (std::size_t a = 0; a < count.size(); ++a)
    count[a].assign(set.axes[a].axis.size(), 0);
  for (Index i = 0; i < scan.size(); ++i)
    if (set.is_covered(i))
      ++count[set.axis_of_point[i]][set.segment_of_point[i]];
  std::vector<std::vector<std::uint8_t>> is_twig(count.size());
  for (std::size_t a = 0; a < count.size(); ++a) {
    const Axis& axis = set.axes[a].axis;
    is_twig[a].assign(axis.size(), 0);
    for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
      double points = 0, length = 0;
      const std::size_t end = std::min(axis.size() - 1, k + rules.window + 1);
      for (std::size_t m = k - std::min(k, rules.window); m < end; ++m) {
        points += count[a][m];
        length += (axis[m + 1].point - axis[m].point).norm();
      }
      is_twig[a][k] = axis[k].radius < thinnest && length < rules.dense * scan.spacing * points;
    }
  }
  std::vector<std::uint8_t> result(scan.size());
  for (Index i = 0; i < scan.size(); ++i)
    result[i] = is_used[i] && !scan.is_outlier[i] &&
                !(set.is_covered(i) && is_twig[set.axis_of_point[i]][set.segment_of_point[i]]);
  return result;
}

namespace internal {

/// Returns a subset of the points of `is_used` that are at least `distance` [L] apart, and within
/// `distance` of all others. Empty if `is_running()` returns `false`. O(points log n).
template <class Is_running>
std::vector<Vec3> thinned_points(const Scan& scan,
                                 std::vector<std::uint8_t> is_used,
                                 double distance,
                                 const Is_running& is_running)
{
  constexpr Index often = 1 << 16;
  std::vector<Vec3> kept;
  std::vector<Index> near;
  for (Index i = 0; i < scan.size(); ++i) {
    if (i % often == 0 && !is_running())
      return {};
    if (!is_used[i])
      continue;
    kept.push_back(scan.points[i]);
    near.clear();
    scan.search->append_within(scan.points[i], distance, near);
    for (const Index j : near)
      is_used[j] = 0;
  }
  return kept;
}

/// Returns the points of the scan that are nearest to the places.
inline std::vector<Index> nearest_points(const Scan& scan, const std::vector<Vec3>& places)
{
  std::vector<Index> nearest;
  for (const Vec3& p : places)
    nearest.push_back(
        scan.search
            ->nearest_if(p, std::numeric_limits<double>::infinity(), [](Index) { return true; })
            .index);
  std::sort(nearest.begin(), nearest.end());
  nearest.erase(std::unique(nearest.begin(), nearest.end()), nearest.end());
  return nearest;
}

/// Returns the axes of points, among which `spacing` [L] is set. Empty if there are too few points,
/// or if `progress` returns `false`.
template <class ConcurrencyTag, class Progress>
Axis_set axes_of_points(const Scan_frame& frame,
                        std::vector<Vec3> points,
                        const std::vector<Vec3>& root,
                        const Axis_options& axes,
                        const Layer_options& options,
                        const Progress& progress,
                        double& spacing)
{
  constexpr std::size_t fewest = 100;
  if (points.size() < fewest)
    return {};
  Scan scan;
  scan.frame = frame;
  scan.points = std::move(points);
  measure_points<ConcurrencyTag>(scan);
  spacing = scan.spacing;
  if (!progress(0.3))
    return {};
  const std::vector<std::uint8_t> is_used(scan.size(), 1);
  Compact_links links(ConcurrencyTag(), scan, is_used, axes.links);
  Linked_parts linked;
  const auto root_is_known = [](const Point_parts&) {};
  link_parts<ConcurrencyTag>(scan, is_used, links, axes.links, root_is_known, linked);
  Layer_tree layers;
  trace_layers<ConcurrencyTag>(scan, nearest_points(scan, root), options, links, linked, layers);
  if (!progress(0.5))
    return {};
  return fit_axes<ConcurrencyTag>(scan, layers, axes, [&](double f) {
    return progress(0.5 + 0.5 * f);
  });
}

} // namespace internal

/*!
  Returns the thick axes of thinned scans, the coarsest first.

  In the shade of a crown, the points of a thick limb may be several times farther apart than those
  of the whole scan. Its level sets then fall apart into strands, each of which becomes a thin axis.
  If the scan is thinned to points at least `f u` apart, with the spacing `u` [L] and each factor
  `f`, limb and twigs are equally dense, and the level sets of the limb are rings again. Dense twigs
  of the fine axes `set` are left out. Axes below `thinnest` times the spacing of the thinned scan
  are dropped; the others are hypotheses (see `add_coarse_pieces()`).

  \param is_used points of the tree
  \param root points of the root
  \param thick least radius of thick wood [L]
  \param progress called with the completed fraction; the result is incomplete if it returns `false`

  O(n log n) for n points.
*/
template <class ConcurrencyTag, class Progress>
std::vector<Coarse_axis> find_coarse_axes(const Scan& scan,
                                          const std::vector<std::uint8_t>& is_used,
                                          const std::vector<Index>& root,
                                          const Axis_set& set,
                                          double thick,
                                          Axis_options axes,
                                          const Layer_options& layers,
                                          const Coarse_axis_options& rules,
                                          const Progress& progress)
{
  std::vector<Coarse_axis> result;
  axes.passes = 1; // later passes find thin axes
  std::vector<Vec3> places;
  for (const Index i : root)
    places.push_back(scan.points[i]);
  const std::vector<std::uint8_t> is_sparse =
      points_of_sparse_wood(scan, is_used, rules, thick, set);
  const double share = 1 / double(rules.factors.size());
  bool is_running = true;
  for (std::size_t k = 0; k < rules.factors.size(); ++k) {
    const auto part = [&](double f) {
      return is_running = is_running && progress(share * (double(k) + f));
    };
    if (!is_running)
      break;
    double spacing = 0;
    const Axis_set coarse = internal::axes_of_points<ConcurrencyTag>(
        scan.frame,
        internal::thinned_points(scan,
                                 is_sparse,
                                 rules.factors[k] * scan.spacing,
                                 [&] { return part(0); }),
        places,
        axes,
        layers,
        part,
        spacing);
    const double thinnest = std::max(rules.thinnest * spacing, thick);
    for (const Fitted_axis& fitted : coarse.axes)
      if (std::any_of(fitted.axis.begin(), fitted.axis.end(), [&](const Axis_node& node) {
            return node.radius >= thinnest;
          }))
        result.push_back({fitted.axis, thinnest});
  }
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_FIND_COARSE_AXES_H
