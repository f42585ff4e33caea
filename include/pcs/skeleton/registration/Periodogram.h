// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Periodogram: search for a step of which many lengths are multiples.

#ifndef PCS_SKELETON_REGISTRATION_PERIODOGRAM_H
#define PCS_SKELETON_REGISTRATION_PERIODOGRAM_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/registration/Scan_grid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// A hypothesis and a step for which many lengths are multiples of the step.
struct Step_peak
{
  std::size_t hypothesis = 0;
  double step = 0;     ///< [L]
  double contrast = 0; ///< mean cosine minus the mean cosine of neighbouring steps [-]
  double score = 0;    ///< contrast in typical deviations of all hypotheses [-]
};

/*!
  Computes a contrast for each hypothesis and step: the mean cosine of the lengths in steps, minus
  the mean of the cosines for a shorter and a longer step. The difference removes components that
  change slowly with the step; they are due to the shape of the surface, not to a grid.
*/
class Periodogram
{
public:
  /// Sets up steps from `shortest` to `longest`, each `ratio` times the previous one. The contrast
  /// compares a step with those `beside` indices before and after it. Lengths count up to `reach`.
  Periodogram(double shortest, double longest, double ratio, std::size_t beside, double reach)
    : m_beside(beside), m_reach(reach)
  {
    const double begin = shortest / std::pow(ratio, double(beside));
    const double end = longest * std::pow(ratio, double(beside));
    for (double step = begin; step <= end; step *= ratio)
      m_steps.push_back(step);
    m_cosine.resize(m_steps.size() * bins);
    for (std::size_t s = 0; s < m_steps.size(); ++s)
      for (std::size_t b = 0; b < bins; ++b)
        m_cosine[s * bins + b] = static_cast<float>(
            std::cos(two_pi * (double(b) + 0.5) * reach / (double(bins) * m_steps[s])));
  }

  /*!
    Computes all contrasts. `lengths_of(hypothesis)(pair)` returns a length, a `float` [L]; lengths
    beyond the reach do not count. O(hypotheses (pairs + steps)).
  */
  template <class ConcurrencyTag, class LengthsOf>
  void compute(std::size_t number_of_hypotheses,
               std::size_t number_of_pairs,
               const LengthsOf& lengths_of)
  {
    m_number_of_pairs = number_of_pairs;
    m_contrast.assign(number_of_hypotheses * size(), 0);
    const float scale = static_cast<float>(double(bins) / m_reach);
    pcs::internal::for_each_index<ConcurrencyTag>(
        number_of_hypotheses,
        [&](std::size_t h) {
          const auto length_of = lengths_of(h);
          std::array<float, bins + 1> histogram{}; // the last one: beyond the reach
          std::array<int, 1024> bin;               // of one batch of pairs, for SIMD instructions
          for (std::size_t begin = 0; begin < number_of_pairs; begin += bin.size()) {
            const std::size_t count = std::min(bin.size(), number_of_pairs - begin);
            for (std::size_t k = 0; k < count; ++k)
              bin[k] = static_cast<int>(
                  std::min(scale * std::abs(length_of(begin + k)), static_cast<float>(bins)));
            for (std::size_t k = 0; k < count; ++k)
              histogram[static_cast<std::size_t>(bin[k])] += 1;
          }
          std::vector<float> mean(m_steps.size());
          for (std::size_t s = 0; s < m_steps.size(); ++s) {
            const float* cosine = &m_cosine[s * bins];
            float sum = 0;
            for (std::size_t b = 0; b < bins; ++b)
              sum += cosine[b] * histogram[b];
            mean[s] = sum / static_cast<float>(number_of_pairs);
          }
          for (std::size_t s = 0; s < size(); ++s)
            m_contrast[h * size() + s] =
                mean[s + m_beside] - 0.5f * (mean[s] + mean[s + 2 * m_beside]);
        },
        16);
  }

  /// Returns the peak with the highest contrast.
  Step_peak highest() const
  {
    Step_peak best;
    for (std::size_t k = 0; k < m_contrast.size(); ++k)
      if (m_contrast[k] > best.contrast)
        best = {k / size(), m_steps[k % size() + m_beside], double(m_contrast[k]), 0};
    return best;
  }

  /// Returns up to `most` peaks whose contrast exceeds `evidence` deviations of all hypotheses,
  /// highest first. Of hypotheses for which `are_alike(g, h)` holds, only the best is kept.
  template <class AreAlike>
  std::vector<Step_peak>
  outstanding(double evidence, std::size_t most, const AreAlike& are_alike) const
  {
    const std::size_t n = m_contrast.size() / size();
    const double chance = std::sqrt(0.75 / double(m_number_of_pairs)); // for random lengths
    std::vector<Step_peak> peaks, chosen;
    std::vector<double> values(n);
    for (std::size_t s = 0; s < size(); ++s) {
      for (std::size_t h = 0; h < n; ++h)
        values[h] = std::abs(double(m_contrast[h * size() + s]));
      const double deviation = std::max(chance, 1.4826 * pcs::internal::lower_median(values));
      for (std::size_t h = 0; h < n; ++h) {
        const double contrast = m_contrast[h * size() + s];
        if (contrast >= evidence * deviation)
          peaks.push_back({h, m_steps[s + m_beside], contrast, contrast / deviation});
      }
    }
    std::stable_sort(peaks.begin(), peaks.end(), [](const Step_peak& a, const Step_peak& b) {
      return a.score > b.score;
    });
    for (const Step_peak& peak : peaks) {
      const auto is_alike = [&](const Step_peak& other) {
        return are_alike(peak.hypothesis, other.hypothesis);
      };
      if (chosen.size() < most && std::none_of(chosen.begin(), chosen.end(), is_alike))
        chosen.push_back(peak);
    }
    return chosen;
  }

private:
  static constexpr std::size_t bins = 256;

  /// Returns the number of steps that have neighbours on both sides.
  std::size_t size() const { return m_steps.size() - 2 * m_beside; }

  std::size_t m_beside, m_number_of_pairs = 0;
  double m_reach;
  std::vector<double> m_steps;
  std::vector<float> m_cosine;   ///< by steps, then by lengths
  std::vector<float> m_contrast; ///< by hypotheses, then by steps
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_PERIODOGRAM_H
