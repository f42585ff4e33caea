// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Multilayer perceptron with one hidden layer of rectified units and one output.

#ifndef PCS_SKELETON_LEAVES_MULTILAYER_PERCEPTRON_H
#define PCS_SKELETON_LEAVES_MULTILAYER_PERCEPTRON_H

#include <algorithm>
#include <array>
#include <cstddef>

namespace pcs {
namespace skeleton {

/// A multilayer perceptron with one hidden layer of rectified linear units and a linear output.
template <std::size_t number_of_features, std::size_t number_of_units>
struct Multilayer_perceptron
{
  double unit_weights[number_of_units][number_of_features];
  double unit_offsets[number_of_units];
  double output_weights[number_of_units];
  double output_offset;

  double operator()(const std::array<double, number_of_features>& features) const
  {
    double result = output_offset;
    for (std::size_t u = 0; u < number_of_units; ++u) {
      double sum = unit_offsets[u];
      for (std::size_t f = 0; f < number_of_features; ++f)
        sum += unit_weights[u][f] * features[f];
      result += output_weights[u] * std::max(0.0, sum);
    }
    return result;
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_MULTILAYER_PERCEPTRON_H
