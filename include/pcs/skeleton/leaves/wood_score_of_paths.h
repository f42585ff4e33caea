// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Wood score of a point from its path to the root: paths from leaves lead through their twigs.

#ifndef PCS_SKELETON_LEAVES_WOOD_SCORE_OF_PATHS_H
#define PCS_SKELETON_LEAVES_WOOD_SCORE_OF_PATHS_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/leaves/Multilayer_perceptron.h>
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

/*!
  The descriptors of the shortest path from a point to the root, and of the paths through the point.
  Weights decrease along a path: `reach` is the distance at which the weight is 1 / e.
*/
struct Path_context
{
  double carried = 1;    ///< paths through the point, including its own [count]
  double upstream = 0;   ///< mean score of the points towards the root, including this one
  double downstream = 0; ///< mean score of the points whose paths pass here; 0: none
  double straightness =
      1; ///< length of the mean step towards the root, divided by the mean step length [-]
};

/*!
  Computes the contexts of all points; points without a path to another one have none. Scores and
  paths are given by point. O(points).
*/
inline std::vector<Path_context> path_contexts(const Scan& scan,
                                               const Shortest_paths& paths,
                                               const std::vector<float>& score,
                                               double reach)
{
  const std::size_t n = scan.size();
  const std::vector<Index> order = tips_first(paths);
  const std::vector<double> carried = carried_paths(paths, order);
  const auto share_of_step = [&](Index i, Index next) {
    return std::exp((paths.distance[next] - paths.distance[i]) / reach);
  };
  std::vector<Path_context> result(n);
  std::vector<double> weight(n, 0);
  for (const Index i : order) {
    const Index next = paths.predecessor[i];
    result[i].carried = carried[i];
    if (next != i) {
      const double share = share_of_step(i, next);
      result[next].downstream += share * (double(score[i]) + result[i].downstream);
      weight[next] += share * (1 + weight[i]);
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    if (weight[i] > 0)
      result[i].downstream /= weight[i];
  struct Sums
  {
    Vec3 step = Vec3::Zero();
    double length = 0, score = 0, weight = 0;
  };
  std::vector<Sums> sums(n);
  std::for_each(order.rbegin(), order.rend(), [&](Index i) {
    Sums s;
    const Index next = paths.predecessor[i];
    if (next != i) {
      s = sums[next];
      const double share = share_of_step(i, next);
      s.step = share * s.step + scan.points[i] - scan.points[next];
      s.length = share * s.length + paths.distance[i] - paths.distance[next];
      s.score *= share;
      s.weight *= share;
    }
    s.score += double(score[i]);
    s.weight += 1;
    sums[i] = s;
    result[i].upstream = s.score / s.weight;
    if (s.length > 0)
      result[i].straightness = s.step.norm() / s.length;
  });
  return result;
}

/// The descriptors by which a point is classified: its score, its path, and the neighbouring
/// points. Lengths are in spacings.
struct Wood_evidence
{
  static constexpr std::size_t number_of_features = 12;

  double score = 0;
  Path_context path;
  double count = 0;                         ///< neighbouring points, including this one [count]
  double mean_score = 0, largest_score = 0; ///< of the neighbours
  double most_carried = 1;                  ///< largest number of paths through a neighbour [count]
  Vec3 mean = Vec3::Zero();                 ///< of the neighbours, relative to the point
  Vec3 mean_of_paths = Vec3::Zero();        ///< the same, weighted by their numbers of paths
  Eigen::Matrix3d covariance_of_paths = Eigen::Matrix3d::Zero(); ///< with these weights

  std::array<double, number_of_features> features() const
  {
    const Vec3 deviation =
        linear_algebra::symmetric_eigen<3>(covariance_of_paths).values.cwiseMax(0).cwiseSqrt();
    return {score,
            mean_score,
            largest_score,
            std::log(most_carried),
            path.upstream,
            path.downstream,
            path.straightness,
            std::log1p(count),
            mean.norm(),
            deviation(1),
            deviation(0),
            mean_of_paths.norm()};
  }
};

/// The extents of the path and of the neighbourhood of a point, in spacings [-].
struct Wood_path_options
{
  double reach = 5;  ///< distance along paths at which the weight is 1 / e
  double radius = 3; ///< of the neighbourhood
};

namespace internal {

constexpr double largest_likeness = 4;  ///< larger log-odds are clipped
constexpr double likeness_of_thick = 3; ///< of points of thick wood

// Trained on scans of 60 virtual trees with leaves, see doc/design/leaf_wood_separation.
// clang-format off
constexpr Multilayer_perceptron<Wood_evidence::number_of_features, 12> likeness_by_evidence = {
{
{-0.2284, -0.3648, -0.1236, -0.1854, -0.4866, -0.08156, -3.087, 0.4602, -1.451, 0.1482, -0.313,
 0.8238},
{0.3162, 0.3385, 0.2668, 0.1155, 0.5082, 0.2628, 3.453, -0.01949, 1.409, -0.93, -0.2813, -1.042},
{-0.2116, 0.3368, -0.2107, -0.1634, -0.2094, -0.3409, 8.374, 0.5249, -1.742, -0.9696, -0.7686,
 -0.1936},
{0.03412, 0.5965, -0.1795, 0.1079, -0.1043, 0.1314, -2.865, 1.236, -1.489, 0.03687, 0.3753, 0.8448},
{-0.08117, -0.1772, -0.109, -0.1597, 0.008984, -0.2544, -0.3008, 1.798, -1.438, 0.6718, -2.017,
 1.029},
{-0.4647, -0.2692, 0.0654, -0.1243, 0.9737, -0.1476, 0.1461, 0.6965, -0.454, 0.05369, -1.296,
 0.7229},
{-0.0341, -0.2768, -0.1506, -0.8187, 0.5337, -0.08642, 11.74, 0.7142, -0.5359, -0.9629, 0.1141,
 0.9346},
{-0.1626, -0.09593, -0.06775, 0.4478, 0.2547, 0.07719, 13.05, -0.2551, 1.118, 2.272, -0.6391,
 -0.2097},
{-0.448, 0.3885, 0.3211, 0.03022, 0.01495, 0.04729, 0.6465, -0.2678, 1.203, 0.2287, 0.6026, 0.1134},
{0.1159, -0.1846, -0.2017, -0.6613, -0.04954, -0.002127, 1.647, 0.6263, -0.4499, 0.5493, -2.021,
 0.1887},
{0.1015, 0.09366, -0.1943, 0.4205, -0.3152, -0.04575, -0.6407, 1.179, -0.1134, 2.359, -1.953,
 -0.696},
{-0.1658, -0.01997, 0.01215, -0.4318, 0.2096, -0.0442, 2.16, 0.8203, -0.9034, -0.284, 0.4573,
 1.308}},
{2.915, -3.107, -5.291, -0.1306, -2.741, -2.305, -10.64, -14.51, -2.291, -1.452, -3.354, -1.549},
{-0.5421, 0.5751, 0.4876, 0.8509, -0.2534, -0.7043, 1.256, 0.9322, -0.4394, -1.67, -0.4571,
 -0.5339},
0.2386};
// clang-format on

} // namespace internal

/// Returns the log-odds of wood against leaves for a point.
inline double wood_probability(const Wood_evidence& evidence)
{
  return internal::likeness_by_evidence(evidence.features());
}

/// Collects the evidence for the used point `i` from the used points of `near`, which include it.
inline Wood_evidence evidence_of_point(const Scan& scan,
                                       const std::vector<std::uint8_t>& is_used,
                                       const std::vector<float>& score,
                                       const std::vector<Path_context>& path,
                                       Index i,
                                       const std::vector<Index>& near)
{
  Wood_evidence e;
  e.score = e.largest_score = double(score[i]);
  e.path = path[i];
  double carried = 0;
  for (const Index j : near) {
    if (!is_used[j])
      continue;
    const Vec3 d = (scan.points[j] - scan.points[i]) / scan.spacing;
    const double w = path[j].carried;
    e.count += 1;
    e.mean_score += double(score[j]);
    e.largest_score = std::max(e.largest_score, double(score[j]));
    e.most_carried = std::max(e.most_carried, w);
    e.mean += d;
    carried += w;
    e.mean_of_paths += w * d;
    e.covariance_of_paths += w * d * d.transpose();
  }
  e.mean_score /= e.count;
  e.mean /= e.count;
  e.mean_of_paths /= carried;
  e.covariance_of_paths =
      e.covariance_of_paths / carried - e.mean_of_paths * e.mean_of_paths.transpose();
  return e;
}

/// Returns the scores for `path_contexts()`: the clipped log-odds from the surroundings, and a
/// constant for thick wood.
inline std::vector<float> scores_of_surroundings(const std::vector<std::uint8_t>& is_used,
                                                 const std::vector<std::uint8_t>& is_thick,
                                                 const std::vector<float>& wood_score)
{
  const auto most = static_cast<float>(internal::largest_likeness);
  std::vector<float> score(is_used.size(), 0);
  for (std::size_t i = 0; i < score.size(); ++i)
    if (is_used[i])
      score[i] = is_thick[i] ? static_cast<float>(internal::likeness_of_thick)
                             : std::min(most, std::max(-most, wood_score[i]));
  return score;
}

/*!
  Computes the log-odds of wood for all used points that are not in thick wood.
  `wood_score` has the log-odds from their surroundings (`wood_probability(Surroundings)`); `paths`
  connect all used points. O(points * neighbours).
*/
template <class ConcurrencyTag>
std::vector<float> wood_score_of_paths(const Scan& scan,
                                       const std::vector<std::uint8_t>& is_used,
                                       const std::vector<std::uint8_t>& is_thick,
                                       const Shortest_paths& paths,
                                       const std::vector<float>& wood_score,
                                       const Wood_path_options& rules = {})
{
  const std::vector<float> score = scores_of_surroundings(is_used, is_thick, wood_score);
  const std::vector<Path_context> path =
      path_contexts(scan, paths, score, rules.reach * scan.spacing);
  std::vector<float> result(score);
  pcs::internal::for_each_block<ConcurrencyTag>(
      scan.size(),
      256,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Index> near;
        for (std::size_t i = begin; i < end; ++i) {
          if (!is_used[i] || is_thick[i])
            continue;
          near.clear();
          scan.search->append_within(scan.points[i], rules.radius * scan.spacing, near);
          result[i] = static_cast<float>(wood_probability(
              evidence_of_point(scan, is_used, score, path, static_cast<Index>(i), near)));
        }
      });
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_WOOD_SCORE_OF_PATHS_H
