// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A shape for the examples: points on a pillar of radius 1 that stands on the origin and is 10
// high.

#ifndef PCS_EXAMPLES_PILLAR_H
#define PCS_EXAMPLES_PILLAR_H

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

/// Makes `n` evenly distributed points, ordered from the foot to the head.
template <class Triple>
std::vector<Triple> make_pillar(std::size_t n)
{
  using FT = std::decay_t<decltype(std::declval<Triple>().x())>;
  constexpr double golden_angle = 2.399963229728653;
  std::vector<Triple> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = golden_angle * static_cast<double>(i);
    points.emplace_back(FT(std::cos(angle)),
                        FT(std::sin(angle)),
                        FT(10 * (double(i) + 0.5) / double(n)));
  }
  return points;
}

#endif // PCS_EXAMPLES_PILLAR_H
