// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Where branches begin, how thick and how long they are, and at which angle they leave the parent.

#ifndef PCS_GENERATORS_HABIT_FIT_BRANCHING_H
#define PCS_GENERATORS_HABIT_FIT_BRANCHING_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/fit_profiles.h>
#include <pcs/generators/habit/fit_range.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/// A branch with its parent; `error`: relative standard error of the ratio of their radii.
struct Child
{
  const Axis *axis, *parent;
  double error, size; ///< `size` of the tree

  double ratio() const { return axis->base_radius() / axis->place_radius; }
  double slenderness() const { return axis->length() / axis->base_radius(); }
  /// The length that the parent leaves to the branch, before the random factor.
  double room() const { return 0.9 * (parent->length() - 0.6 * axis->place_at); }
};

/// The least relative error of a sample; it keeps likelihoods smooth where data are exact.
constexpr double least_error = 0.015;

inline std::vector<Child> children_of(const Samples& trees)
{
  std::vector<Child> result;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      if (a.kind == Axis_kind::branch && a.parent != npos && a.base_radius() <= a.place_radius) {
        const Axis& parent = tree->axes[a.parent];
        result.push_back(
            {&a, &parent, std::max(least_error, std::hypot(a.error, parent.error)), tree->size});
      }
  return result;
}

/// The smallest radius at the base of a branch, and the largest one on the trunk. Returns the
/// number of branches that have about the largest radius; 0 if it does not seem to be a bound.
inline std::size_t fit_extreme_radii(const std::vector<Child>& children, Tree_habit& habit)
{
  constexpr std::size_t fewest = 4;
  std::vector<double> all, on_stems;
  for (const Child& c : children) {
    all.push_back(c.axis->base_radius());
    if (c.parent->kind == Axis_kind::stem)
      on_stems.push_back(c.axis->base_radius());
  }
  habit.smallest_branch = quantile(all, 0.002);
  if (on_stems.empty())
    return 0;
  habit.largest_branch = quantile(on_stems, 0.98);
  std::size_t number = 0, number_below = 0;
  for (const Child& c : children) {
    const double r = c.axis->base_radius() / habit.largest_branch;
    const bool is_large = c.parent->kind == Axis_kind::stem && r > 1 - 2 * c.error;
    number += is_large ? 1 : 0;
    number_below += c.parent->kind == Axis_kind::stem && !is_large && r > 1 - 6 * c.error ? 1 : 0;
  }
  return number >= fewest && number > number_below ? number : 0;
}

/// Insertion angles by `short_row`. Returns the numbers of samples.
inline std::array<std::size_t, 2> fit_insertion(const std::vector<Child>& children,
                                                Tree_habit& habit)
{
  constexpr double least_angle_error = 0.03;
  std::array<std::vector<Range_sample>, 2> angles;
  for (const Child& c : children)
    angles[c.parent->short_row()].push_back({c.axis->insertion, least_angle_error});
  for (std::size_t i = 0; i < 2; ++i)
    if (const auto range = fit_range(angles[i]))
      habit.insertion[i] = *range;
  return {angles[0].size(), angles[1].size()};
}

/// Ratio of length and radius of branches that their parents leave room for.
inline std::size_t fit_slenderness(const std::vector<Child>& children, Tree_habit& habit)
{
  constexpr double shortest = 0.8; // the least random factor of the room
  std::vector<double> all;
  for (const Child& c : children)
    if (c.parent->kind != Axis_kind::stem && !c.axis->is_cut)
      all.push_back(c.slenderness());
  const bool is_on_stems = all.size() < 8; // then the crown shortens branches, too
  if (is_on_stems)
    for (const Child& c : children)
      if (!c.axis->is_cut)
        all.push_back(c.slenderness());
  if (all.size() < 4)
    return 0;
  double largest = quantile(all, 0.95);
  std::size_t number = 0;
  for (int round = 0; round < 3; ++round) {
    std::vector<Range_sample> samples;
    for (const Child& c : children) {
      const bool is_stem = c.parent->kind == Axis_kind::stem;
      const bool is_free =
          is_stem ? is_on_stems : largest * c.axis->base_radius() < shortest * c.room();
      if (is_free && !c.axis->is_cut) {
        const double error = std::max(least_error, c.axis->error);
        samples.push_back({c.slenderness(), error * c.slenderness()});
      }
    }
    const auto range = fit_range(samples);
    if (!range)
      break;
    number = samples.size();
    habit.slenderness = *range;
    largest = range->largest;
  }
  return number;
}

/// Ratio of the radii of branch and parent. Branches that the crown or the largest radius may have
/// made thinner give lower bounds.
inline std::array<std::size_t, 2> fit_child_radius(const std::vector<Child>& children,
                                                   Tree_habit& habit)
{
  std::array<std::vector<Range_sample>, 2> samples;
  for (const Child& c : children) {
    const double r = c.axis->base_radius(), error = std::max(least_error, c.axis->error);
    const double limit = habit.smallest_branch / c.axis->place_radius;
    const bool is_stem = c.parent->kind == Axis_kind::stem;
    const double most =
        std::min(habit.largest_branch, c.axis->length() / (0.6 * habit.slenderness.least));
    const double threshold = (1 - 2 * error) * most;
    const bool is_capped = is_stem && r >= threshold;
    const double value = (is_capped ? threshold : r) / c.axis->place_radius;
    samples[c.parent->short_row()].push_back({value, c.error * value, limit, is_capped});
  }
  for (std::size_t i = 0; i < 2; ++i)
    if (const auto range = fit_range(samples[i]))
      habit.child_radius[i] = *range;
  return {samples[0].size(), samples[1].size()};
}

/// The number of branches per whorl on the stems: gaps below a third of the mean distance of
/// whorls are inside a whorl.
inline std::size_t fit_whorl(const std::vector<Child>& children)
{
  std::vector<std::vector<double>> places;
  const Axis* last = nullptr;
  for (const Child& c : children)
    if (c.parent->kind == Axis_kind::stem) {
      if (c.parent != last || places.empty())
        places.emplace_back();
      last = c.parent;
      places.back().push_back(c.axis->place_at);
    }
  std::vector<double> sizes;
  for (std::vector<double>& at : places) {
    std::sort(at.begin(), at.end());
    double tolerance = 0.3 * (at.back() - at.front()) / static_cast<double>(at.size());
    std::vector<double> found;
    for (int round = 0; round < 4; ++round) {
      found.assign(1, 1);
      for (std::size_t i = 1; i < at.size(); ++i)
        if (at[i] - at[i - 1] <= tolerance)
          found.back() += 1;
        else
          found.push_back(1);
      tolerance = 0.3 * (at.back() - at.front()) / static_cast<double>(found.size());
    }
    sizes.insert(sizes.end(), found.begin(), found.end());
  }
  const double median = quantile(sizes, 0.5);
  return std::isfinite(median) ? static_cast<std::size_t>(std::clamp(median, 1.0, 64.0)) : 1;
}

/// Distances of branches and branchless fractions of the parents, by row.
class Spacing_fit
{
public:
  Spacing_fit(const Samples& trees, const Tree_habit& habit) : m_habit(habit)
  {
    for (const Tree_sample* tree : trees) {
      std::vector<Parent> parents(tree->axes.size());
      for (const Axis& a : tree->axes)
        if (a.kind == Axis_kind::branch && a.parent != npos) {
          Parent& p = parents[a.parent];
          p.number += 1;
          p.first = std::min(p.first, a.place_at / tree->axes[a.parent].length());
        }
      for (std::size_t i = 0; i < parents.size(); ++i) {
        const Axis& a = tree->axes[i];
        if (a.kind == Axis_kind::stub || a.order + 1 >= habit.number_of_orders || a.is_cut)
          continue;
        parents[i].axis = &a;
        parents[i].survival = survival(a, a.radius.front());
        m_parents[a.row()].push_back(parents[i]);
      }
    }
  }

  std::array<std::size_t, 3> fit(Tree_habit& habit) const
  {
    std::array<std::size_t, 3> numbers{};
    for (std::size_t row = 0; row < 3; ++row) {
      const double whorl = row == 0 ? static_cast<double>(habit.whorl) : 1;
      if (const auto bare = fit_bare(m_parents[row]))
        habit.bare[row] = *bare;
      double number = 0, room = 0;
      for (const Parent& p : m_parents[row]) {
        number += static_cast<double>(p.number) / whorl;
        const double visible = visible_length(*p.axis, habit.bare[row]);
        // a series that begins with a branch has on average (1 + 1/12) / 2 more of them
        const double first = 0.54 * survival_at(*p.axis, habit.bare[row]);
        number -= visible > 0 ? first : 0;
        room += visible;
        numbers[row] += p.number;
      }
      if (number > 1)
        habit.spacing[row] = room / number;
    }
    return numbers;
  }

private:
  struct Parent
  {
    const Axis* axis = nullptr;
    std::size_t number = 0;
    double first = 2, survival = 0; ///< fraction of the length; see `survival()`
  };

  /// The probability that a branch at a place of this radius is thick enough to exist.
  double survival(const Axis& parent, double radius) const
  {
    const Value_range& u = m_habit.child_radius[parent.short_row()];
    const double least = std::max(u.least, m_habit.smallest_branch / radius);
    return std::clamp((u.largest - least) / std::max(1e-9, u.largest - u.least), 0.0, 1.0);
  }

  double survival_at(const Axis& parent, double share) const
  {
    const auto after =
        std::lower_bound(parent.at.begin(), parent.at.end(), share * parent.length());
    const auto i =
        std::min(static_cast<std::size_t>(after - parent.at.begin()), parent.radius.size() - 1);
    return survival(parent, parent.radius[i]);
  }

  /// The length above the branchless part, weighted by the probability that branches exist.
  double visible_length(const Axis& parent, double bare) const
  {
    double sum = 0;
    for (std::size_t i = 1; i < parent.at.size(); ++i) {
      const double from = std::max(parent.at[i - 1], bare * parent.length());
      const double radius = (parent.radius[i - 1] + parent.radius[i]) / 2;
      sum += std::max(0.0, parent.at[i] - from) * survival(parent, radius);
    }
    return sum;
  }

  static std::optional<double> fit_bare(const std::vector<Parent>& parents)
  {
    std::vector<double> survivals;
    for (const Parent& p : parents)
      if (p.number > 0)
        survivals.push_back(p.survival);
    if (survivals.empty())
      return std::nullopt;
    const double limit = std::min(0.99, quantile(survivals, 0.75));
    std::vector<double> first;
    for (const Parent& p : parents)
      if (p.number > 0 && p.survival >= limit)
        first.push_back(p.first);
    return std::min(quantile(first, 0.5), 0.95);
  }

  const Tree_habit m_habit;
  std::array<std::vector<Parent>, 3> m_parents;
};

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FIT_BRANCHING_H
