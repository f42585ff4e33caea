// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fits a habit to the branches of trees: direct estimate, correction, intervals.

#ifndef PCS_GENERATORS_HABIT_FIT_SAMPLES_H
#define PCS_GENERATORS_HABIT_FIT_SAMPLES_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/Habit_simulation.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/distributions.h>
#include <pcs/generators/habit/estimate_habit.h>
#include <pcs/generators/habit/fit_bends.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/// Sets the tropism of the trunk to the value by which the trunks tilt as much as measured, with
/// the corrected bends. The squared tilt of `n` trunks has 2 n degrees of freedom (bounds by Wilson
/// and Hilferty 1931).
inline void set_trunk_tropism(const Samples& trees, Tree_habit_fit& fit)
{
  fit.habit.tropism[0] = fit_trunk_tropism(trees, fit.habit);
  const double n = 2 * static_cast<double>(trees.size());
  const auto share = [n](double z) {
    return std::pow(1 - 2 / (9 * n) + z * std::sqrt(2 / (9 * n)), 3);
  };
  Tree_habit low = fit.habit, high = fit.habit;
  for (const Habit_value& v : fit.values)
    if (v.name == "bend[0]") {
      low.bend[0] = std::min(v.least, 0.5);
      high.bend[0] = std::min(v.largest, 0.5);
    }
  for (Habit_value& v : fit.values)
    if (v.name == "tropism[0]") {
      v.value = fit.habit.tropism[0];
      v.least = std::min(v.value, fit_trunk_tropism(trees, low, 1 / share(-1.96)));
      v.largest = std::max(v.value, fit_trunk_tropism(trees, high, 1 / share(1.96)));
      v.standard_error = (v.largest - v.least) / (2 * 1.96);
    }
}

/// Sets the size of each sample.
template <class ConcurrencyTag>
Tree_habit_fit fit_samples(std::vector<Tree_sample>& samples,
                           double smallest_radius,
                           std::uint64_t seed,
                           std::size_t number_of_simulations)
{
  Samples trees;
  Tree_habit_fit fit;
  for (const Tree_sample& sample : samples) {
    trees.push_back(&sample);
    fit.number_of_branches += sample.axes.size();
  }
  const Tree_habit known = Discrete_estimate(trees)();
  fit.allometry = allometry_of(trees, known);
  for (Tree_sample& sample : samples)
    sample.size = sample.axes.front().length() / fit.allometry.height;
  const Habit_estimate direct = estimate_habit(trees, known, fit.allometry, true);
  Habit_simulation<ConcurrencyTag> simulation(trees,
                                              measurement_of(trees, smallest_radius),
                                              fit.allometry,
                                              seed,
                                              number_of_simulations);
  fit.habit = simulation.corrected(direct);
  fit.values = simulation.values(fit.habit, direct);
  set_trunk_tropism(trees, fit);
  fit.distributions = distributions_of(trees);
  fit.number_of_trees = trees.size();
  fit.smallest_radius = smallest_radius;
  fit.crown_margin = direct.crown_margin;
  return fit;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FIT_SAMPLES_H
