// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Log-odds of wood for a point from its surroundings: a multilayer perceptron trained on virtual
// scans.

#ifndef PCS_SKELETON_LEAVES_WOOD_PROBABILITY_H
#define PCS_SKELETON_LEAVES_WOOD_PROBABILITY_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/leaves/Multilayer_perceptron.h>
#include <pcs/skeleton/model/Moments.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pcs {
namespace skeleton {

/// The moments of the points within some distance of a point, which is the origin.
struct Spread : Moments
{
  static constexpr std::size_t number_of_features = 5;

  /// Returns the log count, the standard deviations along the principal axes in descending order,
  /// and the distance of the mean from the origin.
  std::array<double, number_of_features> features() const
  {
    const Vec3 deviation =
        linear_algebra::symmetric_eigen<3>(covariance()).values.cwiseMax(0).cwiseSqrt();
    return {std::log1p(count), deviation(2), deviation(1), deviation(0), mean().norm()};
  }
};

/// The descriptors of the surroundings of a point: spreads within three distances, and the score of
/// the best line.
struct Surroundings
{
  static constexpr std::size_t number_of_spreads = 3;
  static constexpr std::size_t number_of_features =
      number_of_spreads * Spread::number_of_features + 1;

  std::array<Spread, number_of_spreads> spread; ///< each includes the points of the previous ones
  double line = 0;

  std::array<double, number_of_features> features() const
  {
    std::array<double, number_of_features> result;
    auto next = result.begin();
    for (const Spread& s : spread) {
      const auto of_spread = s.features();
      next = std::copy(of_spread.begin(), of_spread.end(), next);
    }
    *next = line;
    return result;
  }
};

namespace internal {

// Trained on scans of 40 virtual trees with leaves, see doc/design/leaf_wood_separation.
// clang-format off
constexpr Multilayer_perceptron<Surroundings::number_of_features, 12> likeness_of_surroundings = {
{
{2.158, -2.137, -0.8619, -0.7728, -1.64, -1.332, -1.295, -0.995, 0.4832, 1.276, -0.1837, 0.393,
 0.1117, -0.07737, 0.04131, -0.137},
{1.479, -0.2693, -0.6825, -0.9676, -1.334, 0.2317, -0.5098, -0.04056, -0.274, -0.02204, -1.422,
 -1.065, -0.8172, 0.02052, 0.4566, -0.1372},
{1.625, 0.1737, -7.25, 0.6791, -2.468, 0.2174, 1.092, 0.2721, -0.4314, 1.037, 0.195, -0.03119,
 0.333, -0.07296, 0.2692, 0.08848},
{-1.711, -1.361, 0.7496, -4.362, -1.866, -0.6055, -2.17, 0.8847, 2.497, 0.8601, -0.1533, -0.7299,
 -0.2296, -0.02515, 0.1336, 0.1911},
{0.6131, -0.2528, -2.003, 2.176, -0.4055, 0.1444, 0.2502, -2.811, -1.102, -0.05488, 0.4277,
 -0.09343, -0.4294, -0.1713, 0.04316, -0.2951},
{-0.5745, 1.418, -0.698, 0.4088, 1.299, 0.5129, 0.02432, -0.5901, -0.1393, -0.1232, -0.5873,
 0.1486, 0.04976, 0.09551, -0.09996, 0.5057},
{-0.1618, -0.2078, -0.2428, -2.811, 0.2281, 0.01546, -0.08155, 0.1982, 4.914, -0.3642, -0.3784,
 0.2823, 0.1378, 0.006701, 0.1093, 0.03602},
{0.302, 1.847, 0.2924, 0.1676, 1.125, 0.6564, 1.191, -0.3398, 0.4992, -0.8782, 1.657, 0.3027,
 0.03892, -0.1974, -0.04744, -0.06284},
{2.716, -1.048, 0.523, -9.551, 0.1889, 0.1596, 0.0698, 0.1108, -0.07939, 0.005081, 0.02741, 0.075,
 -0.0442, 0.06463, 0.1024, -0.1042},
{0.5609, -0.4281, -0.6741, 0.6235, -0.441, 1.808, 0.7472, -0.3846, -0.4893, -0.5902, -0.7832,
 -0.8141, 0.2268, -0.05136, 0.1007, -0.03321},
{-1.57, -0.3573, 0.5135, 0.6463, -0.0233, 0.9321, 0.4081, -0.6919, -1.576, 0.2661, 0.4109, -0.8735,
 0.8239, 0.2299, -0.1189, 0.1206},
{-0.2291, 0.112, -0.08957, -3.346, -1.479, 0.3739, -0.533, 1.349, -0.1192, 0.452, 1.34, 0.1307,
 -0.365, 0.2384, 0.1596, -0.436}},
{5.842, 11.59, -5.662, 15.1, 2.309, -0.852, -0.5171, -13.82, -4.542, -1.399, 0.6533, -2.808},
{-0.7463, -0.5947, 0.8056, 0.8209, 1.262, 1.031, -0.7219, 0.9005, -1.122, -0.9207, -0.4588,
 -0.5577},
-0.6171};
// clang-format on

} // namespace internal

/*!
  Returns the log-odds of wood against leaves for a point with these surroundings [-].

      y = b + sum_{u=1..12} v_u max(0, b_u + sum_{f=1..16} w_uf x_f),   P(wood) = 1 / (1 + exp(-y))

  with the weights of `likeness_of_surroundings`. The features `x` are five values for each of three
  balls about the point, and finally the score of the best line [-]. For `n` points in a ball, they
  are `ln(1 + n)` [-], the standard deviations of these points along the principal axes in
  descending order, and the distance of their mean from the point. Lengths are in radii of the tube
  of `Linear_point_options` [-]. The radii of the balls are 0.29, 0.58 and 1 times its reach. O(1).
*/
inline double wood_probability(const Surroundings& surroundings)
{
  return internal::likeness_of_surroundings(surroundings.features());
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_WOOD_PROBABILITY_H
