// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shape and radius of the crown, from the lengths of the branches on the stems.

#ifndef PCS_GENERATORS_HABIT_FIT_CROWN_H
#define PCS_GENERATORS_HABIT_FIT_CROWN_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/fit_branching.h>
#include <pcs/generators/habit/fit_range.h>
#include <pcs/generators/internal/crown_reach.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

/*
  The length of a branch is the smaller one of s R and u C(x), R being its radius, s its
  slenderness, u the random factor and C(x) the reach of the crown at the fraction x of its height.
  The density of the smaller one of two independent values follows from their densities. A branch
  with the smallest slenderness that occurs was shortened by the crown.
*/
class Crown_fit
{
public:
  /// The crown of a tree is its `size` to the power `exponent` times the fitted one.
  Crown_fit(const std::vector<Child>& children, const Tree_habit& habit, double exponent)
    : m_slenderness(habit.slenderness)
  {
    for (const Child& c : children)
      if (c.parent->kind == Axis_kind::stem && !c.axis->is_cut) {
        const double from = habit.bare[0] * c.parent->length();
        const double x = (c.axis->place_at - from) / std::max(1e-300, c.parent->length() - from);
        const double scale = std::pow(c.size, exponent);
        m_branches.push_back({std::clamp(x, 0.0, 1.0),
                              scale,
                              c.axis->length(),
                              c.axis->base_radius(),
                              std::max(least_error, c.axis->error)});
        m_longest = std::max(m_longest, c.axis->length() / scale);
      }
  }

  std::size_t number_of_branches() const { return m_branches.size(); }

  /// Sets the radius of a crown of the given shape; returns the logarithm of the likelihood.
  double fit_radius(Crown_shape shape, double& radius) const
  {
    double best = -std::numeric_limits<double>::infinity();
    for (int i = -40; i <= 60; ++i) // fifths to triples of the longest branch
      improve(shape, m_longest * std::exp(0.027 * i), best, radius);
    const double centre = radius;
    for (int i = -9; i <= 9; ++i)
      improve(shape, centre * std::exp(0.003 * i), best, radius);
    return best;
  }

  /// Sets shape and radius. Of shapes that are about equally likely, the one with the smallest
  /// radius is chosen, which explains more of the lengths by the crown. Returns the difference of
  /// the logarithms of the likelihoods to the next shape; it is negative for a less likely shape.
  double fit(Tree_habit& habit) const
  {
    constexpr double equally_likely = 2;
    constexpr std::array<Crown_shape, 3> shapes = {Crown_shape::dome,
                                                   Crown_shape::cone,
                                                   Crown_shape::vase};
    std::array<double, 3> likelihood{}, radius{};
    for (std::size_t i = 0; i < shapes.size(); ++i)
      likelihood[i] = fit_radius(shapes[i], radius[i]);
    const double most = *std::max_element(likelihood.begin(), likelihood.end());
    std::size_t best = shapes.size();
    for (std::size_t i = 0; i < shapes.size(); ++i)
      if (likelihood[i] >= most - equally_likely &&
          (best == shapes.size() || radius[i] < radius[best]))
        best = i;
    habit.crown = shapes[best];
    habit.crown_radius = radius[best];
    double margin = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < shapes.size(); ++i)
      if (i != best)
        margin = std::min(margin, likelihood[best] - likelihood[i]);
    return margin;
  }

private:
  struct Branch
  {
    double x, scale, length, radius, error;
  };

  void improve(Crown_shape shape, double radius, double& best, double& best_radius) const
  {
    double sum = 0;
    for (const Branch& b : m_branches)
      sum += log_density(b, b.scale * generators::internal::crown_reach(shape, radius, b.x));
    if (sum <= best)
      return;
    best = sum;
    best_radius = radius;
  }

  double log_density(const Branch& b, double reach) const
  {
    constexpr double outlier_share = 0.03;
    const Blurred_uniform by_crown{0.8 * reach, 1.05 * reach, 0.02 * reach};
    const double least = m_slenderness.least * b.radius, largest = m_slenderness.largest * b.radius;
    const Blurred_uniform by_radius{least, std::max(largest, 1.02 * least), b.error * least};
    const bool is_thinned = b.length < (1 + 2 * b.error) * 0.6 * least;
    const double density = is_thinned
                               ? by_crown.density(b.length)
                               : by_crown.density(b.length) * by_radius.share_above(b.length) +
                                     by_radius.density(b.length) * by_crown.share_above(b.length);
    return std::log((1 - outlier_share) * std::max(0.0, density) + outlier_share / m_longest);
  }

  Value_range m_slenderness;
  std::vector<Branch> m_branches;
  double m_longest = 0;
};

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FIT_CROWN_H
