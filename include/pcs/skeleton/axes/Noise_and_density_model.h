// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Noise, point density and visibility of a scan, learned from fitted axes.

#ifndef PCS_SKELETON_AXES_NOISE_AND_DENSITY_MODEL_H
#define PCS_SKELETON_AXES_NOISE_AND_DENSITY_MODEL_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/axes/fit_fields.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Density_field.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Visibility_field.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Estimator of noise, density and visibility from the samples of fits, added in a fixed order.
class Noise_and_density_model
{
public:
  /// `least_noise`: lower bound on the estimated noise [L].
  explicit Noise_and_density_model(double least_noise) : m_least_noise(least_noise) {}

  void add_deviations(const std::vector<double>& values)
  {
    const std::size_t room = capacity - std::min(capacity, m_deviations.size());
    m_deviations.insert(m_deviations.end(),
                        values.begin(),
                        values.begin() +
                            static_cast<std::ptrdiff_t>(std::min(room, values.size())));
  }
  void add_densities(const std::vector<Density_sample>& samples)
  {
    m_densities.insert(m_densities.end(), samples.begin(), samples.end());
  }

  /// Estimates the noise from `deviations` alone; 0 if they are too few [L].
  double noise_of(std::vector<double> deviations) const
  {
    // the standard deviation of a normal distribution from its median absolute deviation
    return deviations.size() >= enough_deviations
               ? std::max(m_least_noise, 1.4826 * pcs::internal::lower_median(deviations))
               : 0;
  }
  /// Updates the noise and density of `set` if there are enough samples and some are new, and the
  /// fields if their number has grown by half.
  void learn(Axis_set& set)
  {
    if (m_deviations.size() >= enough_deviations && m_deviations.size() != m_learned_deviations) {
      m_learned_deviations = m_deviations.size();
      set.noise = noise_of(m_deviations);
    }
    if (m_densities.size() >= enough_densities &&
        (m_densities.size() != m_learned_densities || set.noise != m_learned_noise)) {
      m_learned_densities = m_densities.size();
      m_learned_noise = set.noise;
      std::vector<double> thick, all;
      for (const Density_sample& s : m_densities) {
        all.push_back(s.density);
        if (s.radius > thick_radius * set.noise)
          thick.push_back(s.density);
      }
      set.density = pcs::internal::lower_median(thick.size() >= enough_densities ? thick : all);
      if (double(m_densities.size()) >= field_growth * double(m_samples_of_field)) {
        m_samples_of_field = std::max(m_densities.size(), Density_field::fewest_samples);
        fit_fields(set);
      }
    }
  }

private:
  void fit_fields(Axis_set& set) const
  {
    std::vector<Density_sample> thick;
    for (const Density_sample& s : m_densities)
      if (s.radius > thick_radius * set.noise)
        thick.push_back(s);
    set.density_field.learn(thick.size() >= enough_thick ? thick : m_densities);
    set.facing_field.learn(thick.size() >= enough_facing ? thick : m_densities);
  }

  static constexpr std::size_t capacity = 40000, enough_deviations = 100, enough_densities = 8,
                               enough_thick = 600, enough_facing = 100;
  static constexpr double field_growth = 1.5; ///< growth of samples that triggers a refit [-]
  //! radius in units of the noise above which the fitted radius and the density are unbiased [-]
  static constexpr double thick_radius = 6;
  double m_least_noise;
  std::vector<double> m_deviations;
  std::vector<Density_sample> m_densities;
  // numbers of samples and noise at the last update
  std::size_t m_learned_deviations = 0, m_learned_densities = 0;
  double m_learned_noise = 0;
  std::size_t m_samples_of_field = 0;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_NOISE_AND_DENSITY_MODEL_H
