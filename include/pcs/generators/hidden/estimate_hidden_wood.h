// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Inferred branches and volumes of one tree, from its axes and the visibility of the scan.

#ifndef PCS_GENERATORS_HIDDEN_ESTIMATE_HIDDEN_WOOD_H
#define PCS_GENERATORS_HIDDEN_ESTIMATE_HIDDEN_WOOD_H

#include <pcs/generators/Hidden_wood.h>
#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/hidden/Beam_visibility.h>
#include <pcs/generators/hidden/Hidden_branches.h>
#include <pcs/generators/hidden/missing_stems.h>
#include <pcs/generators/hidden/pipe_radii.h>
#include <pcs/generators/hidden/radius_correction.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace generators {
namespace hidden {

/// The inferred wood of one tree.
struct Hidden_estimate
{
  std::vector<Inferred_branch> branches; ///< stems first
  std::size_t number_of_stems = 0;
  Inferred_volume hidden_branches, missing_stems, radius_correction;
  Hidden_branches::Rows density_factors{};
};

inline Inferred_volume with_error(double value, double error, double least)
{
  constexpr double width = 2; // standard errors
  return {value, error, std::max(least, value - width * error), value + width * error};
}

inline double volume_of(const std::vector<Inferred_branch>& branches)
{
  double sum = 0;
  for (const Inferred_branch& b : branches)
    sum += volume_of(b);
  return sum;
}

/*
  The volume of hidden branches has three errors: the spread of the grown branches; that of the
  density, which few measured branches determine; and that of the model, a share of the volume. The
  errors of stems and radii are shares of their volumes. All shares were chosen by 45 virtual scans.
*/
struct Error_shares
{
  static constexpr double branches = 0.3, stems = 0.4, added = 0.5, removed = 0.5;
  static constexpr double measured = 0.03; ///< of the volume of the whole tree
};

/// Grows hidden branches several times; the result has those with the median volume.
template <class ConcurrencyTag>
Hidden_estimate estimate_hidden_wood(const habit::Tree_sample& tree,
                                     const Tree_habit& growth,
                                     const Beam_visibility& visibility,
                                     std::uint64_t seed,
                                     std::size_t number_of_simulations)
{
  Hidden_estimate result;
  Hidden_branches hidden(tree, growth, visibility);
  result.density_factors = hidden.scale_density(seed);
  const auto seed_of = [&](std::size_t k) {
    return pcs::internal::Random_stream(seed, 8, k).bits();
  };
  std::vector<std::pair<double, std::size_t>> volumes(number_of_simulations);
  pcs::internal::for_each_index<ConcurrencyTag>(
      number_of_simulations,
      [&](std::size_t k) {
        volumes[k] = {volume_of(hidden.grow(seed_of(k))), k};
      },
      1);
  std::sort(volumes.begin(), volumes.end());
  const double n = static_cast<double>(number_of_simulations);
  double mean = 0, variance = 0;
  for (const auto& [volume, k] : volumes)
    mean += volume / n;
  for (const auto& [volume, k] : volumes)
    variance += std::pow(volume - mean, 2) / std::max(1.0, n - 1);
  const double model = std::hypot(Error_shares::branches, hidden.density_error()) * mean;
  result.hidden_branches = with_error(mean, std::hypot(std::sqrt(variance), model), 0);

  const habit::Tree_sample pipe = with_pipe_radii(tree);
  result.branches = Missing_stems(pipe, growth, visibility)();
  result.number_of_stems = result.branches.size();
  const double stems = volume_of(result.branches);
  result.missing_stems = with_error(stems, Error_shares::stems * stems, 0);
  const Radius_correction r = correct_radii(tree, pipe, visibility);
  const double error = std::hypot(Error_shares::added * r.added, Error_shares::removed * r.removed);
  const double change = r.added - r.removed;
  result.radius_correction = {change, error, change - 2 * error, change + 2 * error};

  const std::size_t first = tree.axes.size(), stem_count = result.number_of_stems;
  for (Inferred_branch& b : hidden.grow(seed_of(volumes[volumes.size() / 2].second))) {
    if (b.parent >= first)
      b.parent += stem_count; // the stems precede the other inferred branches
    result.branches.push_back(std::move(b));
  }
  return result;
}

/// Sets the sum of the inferred volumes, and the total volume with its interval, which contains
/// errors of the measured wood.
inline void
sum_up(const Hidden_estimate& e, double measured, Inferred_volume& inferred, Inferred_volume& total)
{
  double value = 0, variance = 0;
  for (const Inferred_volume* v : {&e.hidden_branches, &e.missing_stems, &e.radius_correction}) {
    value += v->value;
    variance += v->standard_error * v->standard_error;
  }
  const double error = std::sqrt(variance), sum = measured + value;
  // branches and stems have no negative volume; measured axes may lose some
  inferred = with_error(value, error, std::min(0.0, e.radius_correction.least));
  total = with_error(sum, std::hypot(error, Error_shares::measured * sum), 0);
}

/// The share of the length of the measured axes with returns beside them.
inline double scanned_share(const habit::Tree_sample& tree, const Beam_visibility& visibility)
{
  double all = 0, scanned = 0;
  for (const habit::Axis& axis : tree.axes)
    for (std::size_t i = 1; i < axis.points.size(); ++i) {
      const Vector3 middle = (axis.points[i - 1] + axis.points[i]) / 2;
      const double length = axis.at[i] - axis.at[i - 1];
      all += length;
      scanned += visibility.has_return(middle, axis.radius[i]) ? length : 0;
    }
  return all > 0 ? scanned / all : 0;
}

/// The share of the measured wood, rotated about the trunk, that less than a tenth of the beams
/// reaches.
inline double hidden_crown_share(const habit::Tree_sample& tree,
                                 const Beam_visibility& visibility,
                                 std::uint64_t seed)
{
  constexpr std::size_t number_of_turns = 8;
  constexpr double fewest_beams = 0.1; // single beams may be counted in the next cell
  const habit::Axis& trunk = tree.axes.front();
  double all = 0, hidden = 0;
  for (std::size_t a = 1; a < tree.axes.size(); ++a) {
    const habit::Axis& axis = tree.axes[a];
    for (std::size_t i = 1; i < axis.points.size(); ++i) {
      const Vector3& p = axis.points[i];
      const auto above = std::find_if(trunk.points.begin(), trunk.points.end(), [&](const auto& q) {
        return q.z() >= p.z();
      });
      const Vector3& centre = above == trunk.points.end() ? trunk.points.back() : *above;
      pcs::internal::Random_stream random(seed, 9, a, i);
      for (std::size_t k = 0; k < number_of_turns; ++k) {
        const double angle = random.uniform(0, 2 * pcs::internal::pi);
        const Vector3 q = centre + Eigen::AngleAxisd(angle, Vector3::UnitZ()) * Vector3(p - centre);
        const double length = axis.at[i] - axis.at[i - 1];
        all += length;
        hidden += visibility.visible_share(q, axis.radius[i]) < fewest_beams ? length : 0;
      }
    }
  }
  return all > 0 ? hidden / all : 0;
}

} // namespace hidden
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_ESTIMATE_HIDDEN_WOOD_H
