// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The direct estimate of all parameters of a habit from the branches of several trees.

#ifndef PCS_GENERATORS_HABIT_ESTIMATE_HABIT_H
#define PCS_GENERATORS_HABIT_ESTIMATE_HABIT_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/Tree_habit_fit.h>
#include <pcs/generators/habit/Habit_parameters.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/fit_bends.h>
#include <pcs/generators/habit/fit_branching.h>
#include <pcs/generators/habit/fit_crown.h>
#include <pcs/generators/habit/fit_profiles.h>
#include <pcs/generators/habit/fit_range.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/// A habit, and the numbers of samples from which its parameters were estimated.
struct Habit_estimate
{
  Tree_habit habit;
  std::array<std::size_t, number_of_parameters> number{};
  std::array<double, 3> tropism_error{}; ///< by row, from the bends alone
  double crown_margin = 0;               ///< of the logarithm of the likelihood, to the next shape

  /// Sets the number of samples of the parameters whose names begin with `name`.
  void count(const std::string& name, std::size_t samples)
  {
    for (std::size_t i = 0; i < number_of_parameters; ++i)
      if (std::string(habit_parameters()[i].name).rfind(name, 0) == 0)
        number[i] = samples;
  }
};

inline double mean_height(const Samples& trees)
{
  double sum = 0;
  for (const Tree_sample* tree : trees)
    sum += std::log(tree->axes.front().length());
  return std::exp(sum / static_cast<double>(trees.size()));
}

/// Leaders above a fork of the trunk: fork, its angle, and the flattest sections.
inline void estimate_forks(const Samples& trees, Habit_estimate& e)
{
  std::vector<double> places, angles;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      if (a.kind == Axis_kind::stem && a.parent == 0) {
        const Axis& trunk = tree->axes.front();
        places.push_back(a.place_at / trunk.length());
        const std::size_t from = std::min(a.place, trunk.points.size() - 2);
        const std::size_t to = std::min(from + 3, trunk.points.size() - 1);
        const Vector3 p = trunk.points[to] - trunk.points[from];
        const Vector3 q = a.points[std::min<std::size_t>(3, a.points.size() - 1)] - a.points[0];
        angles.push_back(std::atan2(p.cross(q).norm(), p.dot(q)));
      }
  if (e.habit.number_of_leaders < 2 || places.empty())
    return;
  e.habit.fork = quantile(places, 0.5);
  e.count("fork", places.size());
  const double mean = quantile(angles, 0.5);
  double width = 0; // between the ends of a uniform value, from the spread of few samples
  for (const double a : angles)
    width += std::abs(a - mean);
  width *= angles.size() > 1 ? 4 / static_cast<double>(angles.size() - 1) : 0;
  e.habit.fork_angle = {mean - width / 2, mean + width / 2};
  e.count("fork_angle", angles.size() >= 6 ? angles.size() : 0);
}

inline void estimate_sections(const Samples& trees, Habit_estimate& e)
{
  double sum = 0;
  std::size_t number = 0;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      if (std::isfinite(a.flatness)) {
        sum += a.flatness;
        ++number;
      }
  if (number < 4)
    return;
  e.habit.flattest_section = 2 * sum / static_cast<double>(number) - 1;
  e.count("flattest_section", number);
}

/// The values that are counted, or that describe the distances of nodes.
class Discrete_estimate
{
public:
  explicit Discrete_estimate(const Samples& trees) : m_trees(trees) {}

  Tree_habit operator()() const
  {
    Tree_habit h;
    h = h.scaled(mean_height(m_trees) / h.height); // values that are not identified
    const double number = static_cast<double>(m_trees.size());
    double leaders = 0, stubs = 0;
    int orders = 1;
    std::vector<double> trunk_steps, twig_steps;
    for (const Tree_sample* tree : m_trees)
      for (const Axis& a : tree->axes) {
        leaders += a.kind == Axis_kind::stem ? 1 : 0;
        stubs += a.kind == Axis_kind::stub ? 1 : 0;
        orders = std::max(orders, a.order + 1);
        std::vector<double>& steps = a.order == 0 ? trunk_steps : twig_steps;
        for (std::size_t i = 1; i + 1 < a.at.size(); ++i) // the last step is a remainder
          steps.push_back(a.at[i] - a.at[i - 1]);
      }
    h.number_of_orders = std::min(orders, 8);
    h.number_of_leaders =
        static_cast<std::size_t>(std::clamp(std::round(leaders / number), 1., 8.));
    h.number_of_stubs = static_cast<std::size_t>(std::min(1000.0, std::round(stubs / number)));
    const double step = trunk_steps.empty() ? h.height / 120 : quantile(trunk_steps, 0.5);
    h.largest_step = std::clamp(step, h.height / 500, h.height / 20);
    h.bend_length = h.largest_step;
    h.smallest_step = twig_steps.empty() ? 0.3 * h.largest_step : quantile(twig_steps, 0.1);
    h.smallest_step = std::clamp(h.smallest_step, 0.05 * h.largest_step, h.largest_step);
    return h;
  }

private:
  const Samples& m_trees;
};

/// Estimates all continuous parameters. `known` has the discrete ones. `do_choose_whorl_and_crown`:
/// whether those two are estimated, too.
inline Habit_estimate estimate_habit(const Samples& trees,
                                     const Tree_habit& known,
                                     const Habit_allometry& allometry,
                                     bool do_choose_whorl_and_crown)
{
  Habit_estimate e{known, {}, {}, 0};
  Tree_habit& h = e.habit;
  const std::size_t n = trees.size();
  h.height = mean_height(trees);
  h.tip_radius = fit_tip_radius(trees);
  estimate_forks(trees, e);
  estimate_sections(trees, e);
  Trunk_profiles(trees, h).fit(h);
  h.lean = fit_lean(trees);
  for (const char* name :
       {"height", "trunk_radius", "flare", "lean", "taper[0]", "tip_share[0]", "tip_radius"})
    e.count(name, n);
  const std::size_t profiles = fit_branch_profiles(trees, h);
  e.count("taper[1]", profiles);
  e.count("tip_share[1]", profiles);
  const Bend_fit bends(trees, h);
  const auto changes = bends.fit(h);
  e.tropism_error = bends.tropism_errors(h);
  h.tropism[0] = fit_trunk_tropism(trees, h);
  const std::vector<Child> children = children_of(trees);
  const std::size_t largest = children.empty() ? 0 : fit_extreme_radii(children, h);
  e.count("largest_branch", largest);
  e.count("smallest_branch", children.size());
  e.count("slenderness", fit_slenderness(children, h));
  const auto angles = fit_insertion(children, h);
  const auto ratios = fit_child_radius(children, h);
  if (do_choose_whorl_and_crown)
    h.whorl = fit_whorl(children);
  make_valid(h);
  const auto numbers = Spacing_fit(trees, h).fit(h);
  const Crown_fit crown(children, h, allometry.crown_radius_exponent);
  if (crown.number_of_branches() >= 4) {
    if (do_choose_whorl_and_crown)
      e.crown_margin = crown.fit(h);
    else
      crown.fit_radius(h.crown, h.crown_radius);
    e.count("crown_radius", crown.number_of_branches());
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string row = "[" + std::to_string(i) + "]";
    e.count("bend" + row, changes[i]);
    e.count("tropism" + row, changes[i]);
    e.count("spacing" + row, numbers[i]);
    e.count("bare" + row, numbers[i]);
    e.count("insertion" + row, i < 2 ? angles[i] : 0);
    e.count("child_radius" + row, i < 2 ? ratios[i] : 0);
  }
  e.count("bend_renewal", changes[0] + changes[1] + changes[2]);
  e.count("sag", changes[1] + changes[2]);
  make_valid(h);
  return e;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_ESTIMATE_HABIT_H
