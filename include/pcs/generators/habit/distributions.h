// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Distributions of branches by order, and the allometry of several trees.

#ifndef PCS_GENERATORS_HABIT_DISTRIBUTIONS_H
#define PCS_GENERATORS_HABIT_DISTRIBUTIONS_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/estimate_habit.h>
#include <pcs/generators/habit/fit_branching.h>
#include <pcs/generators/habit/fit_crown.h>
#include <pcs/generators/habit/fit_range.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

inline Habit_quantiles quantiles_of(const std::vector<double>& values)
{
  Habit_quantiles result{};
  if (values.empty())
    return result;
  constexpr Habit_quantiles shares = {0.05, 0.25, 0.5, 0.75, 0.95};
  for (std::size_t i = 0; i < shares.size(); ++i)
    result[i] = quantile(values, shares[i]);
  return result;
}

inline Habit_distribution distribution_of_order(const Samples& trees, int order)
{
  std::vector<double> length, radius, slenderness, insertion, ratio, place, children, density;
  for (const Tree_sample* tree : trees) {
    std::vector<double> number(tree->axes.size(), 0);
    for (const Axis& a : tree->axes)
      if (a.parent != npos)
        number[a.parent] += 1;
    for (std::size_t i = 0; i < tree->axes.size(); ++i) {
      const Axis& a = tree->axes[i];
      if (a.order != order)
        continue;
      length.push_back(a.length());
      radius.push_back(a.base_radius());
      slenderness.push_back(a.length() / a.base_radius());
      children.push_back(number[i]);
      density.push_back(number[i] / a.length());
      if (a.parent == npos)
        continue;
      insertion.push_back(a.insertion);
      ratio.push_back(a.base_radius() / a.place_radius);
      place.push_back(a.place_at / tree->axes[a.parent].length());
    }
  }
  Habit_distribution d;
  d.order = order;
  d.number_of_branches = length.size();
  d.length = quantiles_of(length);
  d.base_radius = quantiles_of(radius);
  d.slenderness = quantiles_of(slenderness);
  d.insertion = quantiles_of(insertion);
  d.radius_ratio = quantiles_of(ratio);
  d.place = quantiles_of(place);
  d.number_of_children = quantiles_of(children);
  d.children_per_length = quantiles_of(density);
  return d;
}

inline std::vector<Habit_distribution> distributions_of(const Samples& trees)
{
  int orders = 0;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      orders = std::max(orders, a.order + 1);
  std::vector<Habit_distribution> result;
  for (int order = 0; order < orders; ++order)
    result.push_back(distribution_of_order(trees, order));
  return result;
}

/// A straight line by least squares, with the standard error of its slope.
struct Line_fit
{
  double slope = 0, error = 0;
};
inline Line_fit fit_line(const std::vector<double>& x, const std::vector<double>& y)
{
  const double n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0, rest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  const double slope = xy / xx;
  for (std::size_t i = 0; i < x.size(); ++i)
    rest += std::pow(y[i] - my - slope * (x[i] - mx), 2);
  return {slope, std::sqrt(rest / std::max(1.0, n - 2) / xx)};
}

/// The power laws of three or more trees whose heights differ enough; otherwise the defaults.
inline Habit_allometry allometry_of(const Samples& trees, const Tree_habit& known)
{
  constexpr double least_spread = 0.1;
  Habit_allometry a;
  a.height = mean_height(trees);
  std::vector<double> heights, radii, crowns;
  for (const Tree_sample* tree : trees) {
    const Samples one = {tree};
    const Habit_estimate e = estimate_habit(one, known, Habit_allometry(), true);
    const double height = std::log(e.habit.height);
    heights.push_back(height);
    radii.push_back(std::log(e.habit.trunk_radius));
    crowns.push_back(std::log(e.habit.crown_radius));
    a.height_spread += std::pow(height - std::log(a.height), 2);
  }
  const double n = static_cast<double>(trees.size());
  a.height_spread = trees.size() < 2 ? 0 : std::sqrt(a.height_spread / (n - 1));
  if (trees.size() < 3 || a.height_spread < least_spread)
    return a;
  const Line_fit r = fit_line(heights, radii), c = fit_line(heights, crowns);
  a.trunk_radius_exponent = r.slope;
  a.trunk_radius_error = r.error;
  a.crown_radius_exponent = c.slope;
  a.crown_radius_error = c.error;
  a.is_identified = true;
  return a;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_DISTRIBUTIONS_H
