// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Taper, flare and radii at the tips, by least squares of the logarithms of radii:
// r(x) = R ((1 - s) (1 - x)^t + s) (1 + f exp(-x L / h)), x in [0, 1].

#ifndef PCS_GENERATORS_HABIT_FIT_PROFILES_H
#define PCS_GENERATORS_HABIT_FIT_PROFILES_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/habit/fit_range.h>
#include <pcs/generators/habit/minimise.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

using Samples = std::vector<const Tree_sample*>;

/// A radius at the fraction `x` of the length.
struct Profile_point
{
  double x, log_radius;
};
using Profile = std::vector<Profile_point>;

/// The points of an axis, thinned to about `most`. Where an axis ends with the smallest radius, it
/// is left out as far as it is that thin.
inline Profile profile_of(const Axis& axis, double tip_radius, std::size_t most)
{
  Profile result;
  const double tip = axis.radius.back(), limit = tip < 1.3 * tip_radius ? 1.03 * tip : 0;
  const std::size_t stride = std::max<std::size_t>(1, axis.at.size() / most);
  for (std::size_t i = 0; i < axis.at.size(); i += stride)
    if (axis.radius[i] > limit)
      result.push_back({axis.at[i] / axis.length(), std::log(axis.radius[i])});
  return result;
}

/// The sum of squared deviations from the best multiple of a profile, and its logarithm.
struct Profile_fit
{
  double squares = 0, log_scale = 0;
};
template <class Function>
Profile_fit fit_scale(const Profile& profile, const Function& log_model)
{
  double sum = 0, squares = 0;
  for (const Profile_point& p : profile) {
    const double d = p.log_radius - log_model(p.x);
    sum += d;
    squares += d * d;
  }
  const double n = std::max(1.0, static_cast<double>(profile.size()));
  return {squares - sum * sum / n, sum / n};
}

inline double log_taper(double x, double taper, double share)
{
  return std::log((1 - share) * std::pow(std::max(0.0, 1 - x), taper) + share);
}

/// The radius of tips: the lower quartile of branches that are not cut.
inline double fit_tip_radius(const Samples& trees)
{
  std::vector<double> tips;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      if (!a.is_cut)
        tips.push_back(a.radius.back());
  return quantile(tips, 0.25);
}

/// Fits trunks. The height of the flare is proportional to the length of the trunk.
class Trunk_profiles
{
public:
  Trunk_profiles(const Samples& trees, const Tree_habit& habit)
    : m_fork(habit.number_of_leaders > 1 ? habit.fork : 1)
  {
    for (const Tree_sample* tree : trees)
      m_profiles.push_back(profile_of(tree->axes.front(), habit.tip_radius, 100));
  }

  /// Sets the radius, flare, taper and tips of the trunk of a habit whose height is known.
  void fit(Tree_habit& habit) const
  {
    const auto cost = [this](const std::array<double, 4>& p) {
      double sum = 1e-4 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
      for (const Profile& profile : m_profiles)
        sum += fit_scale(profile, [&](double x) { return log_model(p, x); }).squares;
      return sum;
    };
    std::array<double, 4> best = {std::log(0.8), std::log(0.04), std::log(0.2), std::log(0.03)};
    for (int round = 0; round < 2; ++round)
      best = minimise<4>(cost, best, {0.3, 0.3, 0.3, 0.3});
    double sum = 0;
    for (const Profile& profile : m_profiles)
      sum += fit_scale(profile, [&](double x) { return log_model(best, x); }).log_scale;
    habit.taper[0] = std::exp(best[0]);
    habit.tip_share[0] = share(best[1]);
    habit.flare = flare(best[2]);
    habit.flare_height = flare_height(best[3]) * habit.height;
    habit.trunk_radius = std::exp(sum / static_cast<double>(m_profiles.size()));
  }

private:
  static double share(double log_share) { return std::min(0.95, std::exp(log_share)); }
  /// A flare is a swelling of the base, not the taper of the whole trunk.
  static double flare(double log_flare) { return std::min(5.0, std::exp(log_flare)); }
  static double flare_height(double log_height) { return std::min(0.15, std::exp(log_height)); }
  double log_model(const std::array<double, 4>& p, double x) const
  {
    constexpr double above_fork = 0.85; // as in Tree_growth
    return log_taper(x, std::exp(p[0]), share(p[1])) +
           std::log1p(flare(p[2]) * std::exp(-x / flare_height(p[3]))) +
           (x > m_fork ? std::log(above_fork) : 0);
  }

  std::vector<Profile> m_profiles;
  double m_fork;
};

/// Fits the taper and the tips of branches, from the thickest ones.
inline std::size_t fit_branch_profiles(const Samples& trees, Tree_habit& habit)
{
  constexpr std::size_t most_branches = 80;
  std::vector<const Axis*> axes;
  for (const Tree_sample* tree : trees)
    for (const Axis& a : tree->axes)
      if (a.kind == Axis_kind::branch && !a.is_cut && a.base_radius() > 2 * habit.tip_radius)
        axes.push_back(&a);
  std::stable_sort(axes.begin(), axes.end(), [](const Axis* a, const Axis* b) {
    return a->base_radius() > b->base_radius();
  });
  axes.resize(std::min(axes.size(), most_branches));
  std::vector<Profile> profiles;
  for (const Axis* a : axes)
    if (Profile profile = profile_of(*a, habit.tip_radius, 12); profile.size() >= 4)
      profiles.push_back(std::move(profile));
  if (profiles.empty())
    return 0;
  const auto share = [](double log_share) { return std::min(0.95, std::exp(log_share)); };
  const auto cost = [&](const std::array<double, 2>& p) {
    double sum = 1e-4 * (p[0] * p[0] + p[1] * p[1]);
    for (const Profile& profile : profiles)
      sum += fit_scale(profile, [&](double x) {
               return log_taper(x, std::exp(p[0]), share(p[1]));
             }).squares;
    return sum;
  };
  const auto best = minimise<2>(cost, {std::log(0.7), std::log(0.08)}, {0.3, 0.3});
  habit.taper[1] = std::exp(best[0]);
  habit.tip_share[1] = share(best[1]);
  return profiles.size();
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FIT_PROFILES_H
