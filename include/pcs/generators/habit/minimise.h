// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Minimisation of functions of a few variables without derivatives (Nelder and Mead 1965).

#ifndef PCS_GENERATORS_HABIT_MINIMISE_H
#define PCS_GENERATORS_HABIT_MINIMISE_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pcs {
namespace generators {
namespace habit {

/// Returns the place of a local minimum of `f` near `start`; `step`: size of the first simplex.
template <std::size_t n, class Function>
std::array<double, n> minimise(const Function& f,
                               const std::array<double, n>& start,
                               const std::array<double, n>& step,
                               int number_of_iterations = 40 * static_cast<int>(n))
{
  using Place = std::array<double, n>;
  using Vertex = std::pair<double, Place>;
  std::array<Vertex, n + 1> simplex;
  for (std::size_t i = 0; i <= n; ++i) {
    Place p = start;
    if (i > 0)
      p[i - 1] += step[i - 1];
    simplex[i] = {f(p), p};
  }
  const auto less = [](const Vertex& a, const Vertex& b) { return a.first < b.first; };
  for (int k = 0; k < number_of_iterations; ++k) {
    std::stable_sort(simplex.begin(), simplex.end(), less);
    Place centre{};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        centre[j] += simplex[i].second[j] / static_cast<double>(n);
    const auto beyond = [&](double t) {
      Place p;
      for (std::size_t j = 0; j < n; ++j)
        p[j] = centre[j] + t * (simplex[n].second[j] - centre[j]);
      return Vertex{f(p), p};
    };
    const Vertex reflected = beyond(-1);
    if (reflected.first < simplex[0].first) {
      simplex[n] = std::min(reflected, beyond(-2), less);
      continue;
    }
    if (reflected.first < simplex[n - 1].first) {
      simplex[n] = reflected;
      continue;
    }
    const Vertex contracted = beyond(reflected.first < simplex[n].first ? -0.5 : 0.5);
    if (contracted.first < std::min(reflected.first, simplex[n].first)) {
      simplex[n] = contracted;
      continue;
    }
    for (std::size_t i = 1; i <= n; ++i) {
      for (std::size_t j = 0; j < n; ++j)
        simplex[i].second[j] = (simplex[i].second[j] + simplex[0].second[j]) / 2;
      simplex[i].first = f(simplex[i].second);
    }
  }
  return std::min_element(simplex.begin(), simplex.end(), less)->second;
}

} // namespace habit
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HABIT_MINIMISE_H
