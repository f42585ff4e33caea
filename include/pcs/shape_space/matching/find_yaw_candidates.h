// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Candidates for the yaw between two trees.

#ifndef PCS_SHAPE_SPACE_MATCHING_FIND_YAW_CANDIDATES_H
#define PCS_SHAPE_SPACE_MATCHING_FIND_YAW_CANDIDATES_H

#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/Matching_energy.h>
#include <pcs/shape_space/model/Alignment_options.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// A yaw of tree 2, and the quick cost of the trunks with their children.
struct Yaw_and_cost
{
  double angle, cost;
  std::size_t path_1, path_2; ///< trunks
};

/// Returns the angle of the rotation about `axis` that is nearest to `rotation`, or `angle` if all
/// are equally near. [rad]
inline double
nearest_yaw(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& axis, double angle)
{
  const Eigen::Matrix3d skew = rotation - rotation.transpose();
  const double sine = axis.dot(Eigen::Vector3d(skew(2, 1), skew(0, 2), skew(1, 0)));
  const double cosine = rotation.trace() - axis.dot(rotation * axis);
  return std::hypot(sine, cosine) > 1e-9 ? std::atan2(sine, cosine) : angle;
}

/// Limits of the work of a search.
struct Yaw_limits
{
  bool are_trunks_kept = false; ///< each start keeps its first pair of trunks
  /// The heaviest children of trunks by which this pair is found. [count]
  std::size_t number_of_children = Matching_energy::most_children;
};

/// Many branches at one node are as many children of each of as many trunks. Without limits, time
/// would then grow with the fourth power of their number. Other trees have no limits.
inline Yaw_limits find_yaw_limits(const Matching_energy& energy)
{
  constexpr double most_pairs_of_children = 750000, fewest = 48;
  double pairs_of_trunks = 1, pairs_of_children = 1;
  for (const int t : {0, 1}) {
    const std::vector<std::size_t>& trunks = energy.paths(t).paths_of[0];
    std::size_t most = 0;
    for (const std::size_t p : trunks)
      most = std::max(most, energy.path(t, p).children.size());
    pairs_of_trunks *= static_cast<double>(trunks.size());
    pairs_of_children *= static_cast<double>(std::min(most, Matching_energy::most_children));
  }
  Yaw_limits limits;
  if (pairs_of_trunks * pairs_of_children <= most_pairs_of_children)
    return limits;
  limits.are_trunks_kept = true;
  limits.number_of_children = static_cast<std::size_t>(
      std::max(fewest, std::sqrt(most_pairs_of_children / pairs_of_trunks)));
  return limits;
}

/// Alternates between the best pair of trunks and the yaw that aligns its children, from the yaw
/// `best`. If trunks are kept, all pairs are compared only once, if `do_find_trunks`.
inline Yaw_and_cost refine_yaw_candidate(const Matching_energy& energy,
                                         const Vec3& axis,
                                         Yaw_and_cost best,
                                         bool do_find_trunks,
                                         int passes,
                                         const Yaw_limits& limits)
{
  constexpr int passes_of_rotation = 3;
  constexpr double least_step = 1e-12; // [rad]
  for (int pass = 0;; ++pass) {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(best.angle, axis).toRotationMatrix();
    Matching_energy::Child_cost_cache prices;
    best.cost = std::numeric_limits<double>::infinity();
    const auto compare = [&](std::size_t p1, std::size_t p2, std::size_t number) {
      const double cost = energy.quick_cost_of_paths(p1, p2, rotation, best.cost, prices, number);
      if (cost < best.cost)
        best = {best.angle, cost, p1, p2};
    };
    if (limits.are_trunks_kept && (pass > 0 || !do_find_trunks))
      compare(best.path_1, best.path_2, Matching_energy::most_children);
    else
      for (const std::size_t p1 : energy.paths(0).paths_of[0])
        for (const std::size_t p2 : energy.paths(1).paths_of[0])
          compare(p1, p2, limits.number_of_children);
    if (pass == passes)
      return best;
    const double next =
        nearest_yaw(energy.quick_turn(best.path_1, best.path_2, rotation, passes_of_rotation),
                    axis,
                    best.angle);
    const bool is_estimate = limits.are_trunks_kept && pass == 0; // of the cost
    if (std::abs(next - best.angle) < least_step && !is_estimate)
      return best;
    best.angle = next;
  }
}

} // namespace internal

/*!
  Finds angles about the vertical for which branches agree, the most promising first. [rad]

  From 24 start angles, the yaw is refined by the branches on the trunks, without their subtrees. If
  many branches begin at one node, each start finds its trunks once, by their heaviest children.
  Angles below one step are discarded: small differences between aligned trees are represented by
  rotations of branches. The result is empty if `progress` asks to stop.
*/
template <class ConcurrencyTag>
std::vector<double> find_yaw_candidates(const Matching_energy& energy,
                                        const Vec3& up,
                                        std::size_t most,
                                        pcs::internal::Progress& progress)
{
  using internal::Yaw_and_cost;
  constexpr std::size_t number_of_starts = 24, batch = 4;
  constexpr double pi = pcs::internal::pi, step = 2 * pi / number_of_starts;
  constexpr int first_passes = 3, last_passes = 20;
  const Vec3 axis = energy.frame().transpose() * up;
  const internal::Yaw_limits limits = internal::find_yaw_limits(energy);
  std::vector<Yaw_and_cost> yaws(number_of_starts);
  static_assert(number_of_starts % batch == 0);
  for (std::size_t first = 0; first < number_of_starts; first += batch) {
    if (!progress(0))
      return {};
    pcs::internal::for_each_index<ConcurrencyTag>(
        batch,
        [&](std::size_t i) {
          const std::size_t k = first + i;
          yaws[k] = internal::refine_yaw_candidate(energy,
                                                   axis,
                                                   {step * static_cast<double>(k), 0, 0, 0},
                                                   true,
                                                   first_passes,
                                                   limits);
        },
        1);
  }
  std::stable_sort(yaws.begin(), yaws.end(), [](const Yaw_and_cost& a, const Yaw_and_cost& b) {
    return a.cost < b.cost;
  });
  std::vector<double> result;
  for (const Yaw_and_cost& t : yaws) {
    const auto is_new = [&](double angle) {
      const auto distance = [&](double other) {
        return std::abs(std::remainder(angle - other, 2 * pi));
      };
      return distance(0) > step && std::all_of(result.begin(), result.end(), [&](double other) {
               return distance(other) > 0.5 * step;
             });
    };
    if (result.size() == most || !is_new(t.angle))
      continue;
    if (!progress(0))
      return {};
    const double angle =
        internal::refine_yaw_candidate(energy, axis, t, false, last_passes, limits).angle;
    if (is_new(angle))
      result.push_back(angle);
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_FIND_YAW_CANDIDATES_H
