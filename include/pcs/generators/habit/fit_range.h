// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The range of a uniform value from samples with errors, lower bounds, and a limit of detection.

#ifndef PCS_GENERATORS_HABIT_FIT_RANGE_H
#define PCS_GENERATORS_HABIT_FIT_RANGE_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/minimise.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/median.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace pcs {
namespace generators {
namespace habit {

struct Range_sample
{
  double value, error;         ///< the value with its standard error
  double limit = 0;            ///< a smaller value would not have been seen; 0: none
  bool is_lower_bound = false; ///< whether the true value is at least `value`
};

inline double normal_density(double z)
{
  return std::exp(-z * z / 2) / std::sqrt(2 * pcs::internal::pi);
}
inline double normal_share(double z)
{
  return std::erfc(-z / std::sqrt(2.0)) / 2;
}

/// The sum of a uniform value in [least, largest] and a normal error.
struct Blurred_uniform
{
  double least, largest, error;

  double density(double x) const
  {
    return (normal_share((largest - x) / error) - normal_share((least - x) / error)) /
           (largest - least);
  }
  /// The probability of a value above `x`.
  double share_above(double x) const
  {
    const auto mean_excess = [&](double end) {
      const double z = (end - x) / error;
      return error * (z * normal_share(z) + normal_density(z));
    };
    return (mean_excess(largest) - mean_excess(least)) / (largest - least);
  }
};

inline double quantile(std::vector<double> values, double share)
{
  if (values.empty())
    return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(rank);
  const std::size_t j = std::min(i + 1, values.size() - 1);
  return values[i] + (rank - static_cast<double>(i)) * (values[j] - values[i]);
}

/*
  Maximum likelihood. A sample has the density of the blurred uniform value divided by the
  probability that it exceeds its limit; a lower bound has the probability of exceeding it. A small
  share of other values keeps single outliers from widening the range.
*/
class Range_likelihood
{
public:
  static constexpr std::size_t most_samples = 250;
  static constexpr double outlier_share = 0.08;

  explicit Range_likelihood(const std::vector<Range_sample>& all)
  {
    const std::size_t n = std::min(all.size(), most_samples);
    for (std::size_t i = 0; i < n; ++i)
      m_samples.push_back(all[i * all.size() / n]);
    std::vector<double> values;
    for (const Range_sample& s : m_samples)
      values.push_back(s.value);
    m_low = quantile(values, 0.05);
    m_high = quantile(values, 0.95);
    m_least_width = 0.01 * std::max(std::abs(m_high), std::abs(m_low));
    m_background = 0.5 / std::max({1e-300, m_high - m_low, m_least_width});
  }

  Value_range operator()() const
  {
    const double width = std::max(m_high - m_low, m_least_width);
    const std::array<double, 2> start = {(m_low + m_high) / 2, std::log(width)};
    const auto best =
        minimise<2>([this](const auto& p) { return cost(p); }, start, {0.1 * width, 0.1}, 50);
    const double half = std::max(std::exp(best[1]), m_least_width) / 2;
    return {best[0] - half, best[0] + half};
  }

private:
  double cost(const std::array<double, 2>& p) const
  {
    const double half = std::max(std::exp(p[1]), m_least_width) / 2;
    double sum = 0;
    for (const Range_sample& s : m_samples) {
      const Blurred_uniform u{p[0] - half, p[0] + half, s.error};
      double likelihood =
          s.is_lower_bound ? u.share_above(s.value) : u.density(s.value) / scale(s, u);
      likelihood = s.is_lower_bound
                       ? (1 - outlier_share) * likelihood / scale(s, u) + outlier_share
                       : (1 - outlier_share) * likelihood + outlier_share * m_background;
      sum -= std::log(std::max(likelihood, 1e-300));
    }
    return sum;
  }

  static double scale(const Range_sample& s, const Blurred_uniform& u)
  {
    return s.limit > 0 ? std::max(u.share_above(s.limit), 1e-3) : 1;
  }

  std::vector<Range_sample> m_samples;
  double m_low = 0, m_high = 0, m_background = 1, m_least_width = 0;
};

/// Returns nothing for fewer than four samples.
inline std::optional<Value_range> fit_range(const std::vector<Range_sample>& samples)
{
  if (samples.size() < 4)
    return std::nullopt;
  return Range_likelihood(samples)();
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_FIT_RANGE_H
