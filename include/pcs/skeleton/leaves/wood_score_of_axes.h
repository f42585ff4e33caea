// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Wood score of an axis: a branch, or an artefact fitted to leaves.

#ifndef PCS_SKELETON_LEAVES_WOOD_SCORE_OF_AXES_H
#define PCS_SKELETON_LEAVES_WOOD_SCORE_OF_AXES_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/leaves/Multilayer_perceptron.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Index_groups.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// The descriptors by which an axis is classified. Lengths are in spacings.
struct Axis_evidence
{
  static constexpr std::size_t number_of_features = 12;

  double length = 0;
  double length_in_breast_heights = 0;
  double mean_likeness = 0;    ///< of its points
  double high_likeness = 0;    ///< upper quintile of its points
  double residual = 0;         ///< mean distance of its points from its surface
  double local_spacing = 0;    ///< mean over its points
  double width = 0, depth = 0; ///< minor standard deviations of its points, by the largest [-]
  double leaves = 0;           ///< fraction of unused neighbours of its points [-]
  double parent_length = 0;    ///< 0: none
  double carried = 1; ///< largest number of paths to the root through one of its points [count]
  double seen = 0;    ///< fraction of its segments with points [-]

  std::array<double, number_of_features> features() const
  {
    const double least = 1e-3; // lower bound of lengths before the logarithm
    return {std::log(std::max(least, length)),
            std::log(std::max(least, length_in_breast_heights)),
            mean_likeness,
            high_likeness,
            residual,
            local_spacing,
            depth,
            width,
            leaves,
            std::log1p(parent_length),
            std::log(carried),
            seen};
  }
};

namespace internal {

constexpr double surest = 6; ///< larger log-odds are clipped

// Trained on scans of 75 virtual trees with leaves, see doc/design/leaf_wood_separation.
// clang-format off
constexpr Multilayer_perceptron<Axis_evidence::number_of_features, 12> likeness_by_axis = {
{
{1.274, -1.018, 0.07954, 0.087, -1.088, -0.234, -5.368, 1.536, -1.12, 0.04187, -0.6504, 0.4024},
{0.3845, 0.3278, 0.3052, -0.1163, -1.645, 0.4421, 5.142, -5.406, -0.407, 0.9249, -0.1344, 0.001338},
{1.06, -0.7143, 0.1603, -0.2982, -3.422, 0.3307, 2.813, -0.02045, -4.241, -0.1239, 0.1175, 0.9395},
{0.3774, 0.1514, -0.4311, -0.5786, -2.908, -0.03113, -3.817, -0.4365, -0.3087, 0.07256, -0.2744,
 1.745},
{0.3018, -0.297, -0.5284, 0.6973, -0.08922, -1.083, -1.541, 0.2647, 1.676, -0.04495, 0.1011,
 0.2395},
{0.6064, -0.3298, -0.07301, 2.327, -2.869, -0.3028, 0.4228, 0.8442, -1.364, -0.001253, 0.01067,
 0.4607},
{0.5484, -0.2744, -0.9248, -0.9144, -1.874, 0.2906, -2.455, -1.104, -0.9368, 0.0588, -0.1036,
 1.299},
{0.5309, -0.01934, 0.2185, -0.006858, -9.361, -0.09024, -1.911, 2.279, -0.1595, 0.124, 0.08833,
 -2.29},
{-0.3006, 0.5413, 1.168, -0.6162, 0.8045, -0.9109, 2.297, 0.8654, 0.5631, 0.05062, -0.1483, 0.209},
{0.5754, -0.3904, 0.01866, 0.169, -1.857, 0.01634, -31.65, -2.616, -0.139, 0.089, 0.02342, -0.2995},
{0.2082, 0.8069, 0.2841, -0.1679, 0.1767, -0.02302, 11.25, -7.452, 0.4678, 0.08454, -0.02799,
 -2.953},
{1.72, 0.4728, 0.2148, -0.3629, -1.741, 0.0667, 3.446, -8.735, 0.2338, -0.0123, -0.3534, 2.547}},
{-2.809, -3.06, -4.07, 3.021, -0.2759, -8.085, 0.5296, 2.312, 2.75, -1.477, 2.75, -3.14},
{-1.415, 0.6983, 1.288, 1.156, -0.7827, 1.601, -1.408, 0.7714, -1.131, -2.883, -1.41, 1.277},
0.5759};
// clang-format on

} // namespace internal

/// Returns the log-odds of wood against leaves for an axis.
inline double wood_probability(const Axis_evidence& evidence)
{
  return internal::likeness_by_axis(evidence.features());
}

namespace internal {

/// Adds the evidence of the points of an axis. `carried` is the number of paths through each point.
template <class Points>
void add_evidence_of_points(const Scan& scan,
                            const Axis_set& set,
                            const std::vector<std::uint8_t>& is_used,
                            const std::vector<float>& wood_score,
                            const std::vector<double>& carried,
                            const Axis& axis,
                            const Points& points,
                            Axis_evidence& e)
{
  Vec3 mean = Vec3::Zero();
  double neighbors = 0;
  std::vector<float> of_points;
  std::vector<Index> segments;
  for (const Index i : points) {
    mean += scan.points[i];
    of_points.push_back(wood_score[i]);
    segments.push_back(set.segment_of_point[i]);
    e.mean_likeness += std::min(surest, std::max(-surest, double(wood_score[i])));
    e.residual += std::abs(set.height_above(i, scan.points[i]));
    e.local_spacing += scan.local_spacing[i];
    e.carried = std::max(e.carried, carried[i]);
    for (const Index j : scan.neighbors[i])
      if (j != none) {
        neighbors += 1;
        e.leaves += !is_used[j];
      }
  }
  const auto count = double(of_points.size());
  mean /= count;
  e.mean_likeness /= count;
  e.residual /= count * scan.spacing;
  e.local_spacing /= count * scan.spacing;
  e.leaves /= std::max(1.0, neighbors);
  e.high_likeness = double(pcs::internal::value_of_rank(of_points, of_points.size() * 4 / 5));
  std::sort(segments.begin(), segments.end());
  segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
  e.seen = double(segments.size()) / std::max(1.0, double(axis.size()) - 1);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Index i : points) {
    const Vec3 d = scan.points[i] - mean;
    covariance += d * d.transpose();
  }
  const Vec3 spread = linear_algebra::symmetric_eigen<3>(covariance).values.cwiseMax(0);
  if (spread(2) > 0) {
    e.depth = std::sqrt(spread(0) / spread(2));
    e.width = std::sqrt(spread(1) / spread(2));
  }
}

} // namespace internal

/// Collects the evidence for every axis. `wood_score` has the log-odds of the points; `paths`
/// connect all used points. O(points).
template <class ConcurrencyTag>
std::vector<Axis_evidence> evidence_of_axes(const Scan& scan,
                                            const Axis_set& set,
                                            const std::vector<std::uint8_t>& is_used,
                                            const Shortest_paths& paths,
                                            const std::vector<float>& wood_score,
                                            double breast_height)
{
  const std::size_t m = set.axes.size();
  const Index_groups points_of_axis(m, set.axis_of_point);
  const std::vector<double> carried = carried_paths(paths, tips_first(paths));
  std::vector<double> length(m);
  for (std::size_t a = 0; a < m; ++a)
    length[a] = length_of(set.axes[a].axis);
  std::vector<Axis_evidence> result(m);
  pcs::internal::for_each_index<ConcurrencyTag>(
      m,
      [&](std::size_t a) {
        Axis_evidence& e = result[a];
        const Fitted_axis& fitted = set.axes[a];
        e.length = length[a] / scan.spacing;
        e.length_in_breast_heights = length[a] / breast_height;
        if (fitted.parent != none)
          e.parent_length = length[fitted.parent] / scan.spacing;
        const auto points = points_of_axis[a];
        if (!points.empty())
          internal::add_evidence_of_points(scan,
                                           set,
                                           is_used,
                                           wood_score,
                                           carried,
                                           fitted.axis,
                                           points,
                                           e);
      },
      64);
  return result;
}

/*!
  Marks the points of wood axes and the points without an axis that resemble wood; others are leaves
  or outliers. The parent of a wood axis is wood, and so is the first axis. The parameters are those
  of `evidence_of_axes()`; `least` is the least log-odds of an axis, `least_of_point` those of a
  point without an axis. O(points).
*/
template <class ConcurrencyTag>
std::vector<std::uint8_t> wood_of_scored_axes(const Scan& scan,
                                              const Axis_set& set,
                                              const std::vector<std::uint8_t>& is_used,
                                              const Shortest_paths& paths,
                                              const std::vector<float>& wood_score,
                                              double breast_height,
                                              double least,
                                              double least_of_point)
{
  const std::vector<Axis_evidence> evidence =
      evidence_of_axes<ConcurrencyTag>(scan, set, is_used, paths, wood_score, breast_height);
  // parents come before their children
  std::vector<std::uint8_t> is_of_wood(evidence.size(), 0);
  for (std::size_t a = evidence.size(); a-- > 0;) {
    if (a == 0 || wood_probability(evidence[a]) >= least)
      is_of_wood[a] = 1;
    if (is_of_wood[a] && set.axes[a].parent != none)
      is_of_wood[set.axes[a].parent] = 1;
  }
  std::vector<std::uint8_t> is_wood(scan.size(), 0);
  for (Index i = 0; i < scan.size(); ++i)
    is_wood[i] = is_used[i] && (set.is_covered(i) ? is_of_wood[set.axis_of_point[i]] != 0
                                                  : double(wood_score[i]) >= least_of_point);
  return is_wood;
}

/// Adds the used points within `reach` radii of the nodes of an axis. O(points without wood x
/// nodes).
template <class ConcurrencyTag>
void keep_around(const Scan& scan,
                 const Axis& axis,
                 double reach,
                 const std::vector<std::uint8_t>& is_used,
                 std::vector<std::uint8_t>& is_wood)
{
  pcs::internal::for_each_index<ConcurrencyTag>(scan.size(), [&](std::size_t i) {
    if (is_used[i] && !is_wood[i])
      is_wood[i] = std::any_of(axis.begin(), axis.end(), [&](const Axis_node& node) {
        return (scan.points[i] - node.point).norm() < reach * node.radius;
      });
  });
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_WOOD_SCORE_OF_AXES_H
