// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Soft correspondences between two small clouds: every source point is attracted by all target
// points, with probabilities.

#ifndef PCS_REGISTRATION_SOFT_MATCHES_H
#define PCS_REGISTRATION_SOFT_MATCHES_H

#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace pcs {
namespace registration {

using Vec3 = Eigen::Vector3d;

/// Expected correspondences of the source points.
struct Soft_matches
{
  std::vector<double> weight; ///< sum of the probabilities of each source point [-]
  std::vector<Vec3> target;   ///< mean of the target points, weighted by probabilities [L]
  double total = 0;           ///< sum of the weights [-]
  double variance = 0;        ///< mean squared distance along one coordinate [L^2]
};

/*!
  Expectation step of coherent point drift (Myronenko and Song 2010): the source points are centres
  of Gaussians of the variance `variance`, and the target points are drawn from them, or from a
  uniform distribution with probability `outlier_share`,

      P_ij = exp(-|y_j - x_i|^2 / 2 s^2) / (sum_k exp(-|y_j - x_k|^2 / 2 s^2) + c),
      c = (2 pi s^2)^(3/2) outlier_share / (1 - outlier_share) n / volume.

  O(source points times target points).
  \param volume of the region of the uniform distribution [L^3]
*/
template <class ConcurrencyTag>
void find_soft_matches(const std::vector<Vec3>& source,
                       const std::vector<Vec3>& target,
                       double variance,
                       double outlier_share,
                       double volume,
                       Soft_matches& result)
{
  const std::size_t n = source.size(), m = target.size();
  const double factor = -0.5 / variance;
  const double c = std::pow(2 * pcs::internal::pi * variance, 1.5) * outlier_share /
                   (1 - outlier_share) * static_cast<double>(n) / volume;
  std::vector<double> inverse(m);
  pcs::internal::for_each_index<ConcurrencyTag>(
      m,
      [&](std::size_t j) {
        double sum = c;
        for (std::size_t i = 0; i < n; ++i)
          sum += std::exp(factor * (source[i] - target[j]).squaredNorm());
        inverse[j] = sum > 0 ? 1 / sum : 0;
      },
      32);
  result.weight.resize(n);
  result.target.resize(n);
  std::vector<double> squares(n);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t i) {
        double weight = 0, square = 0;
        Vec3 mean = Vec3::Zero();
        for (std::size_t j = 0; j < m; ++j) {
          const double d2 = (source[i] - target[j]).squaredNorm();
          const double p = std::exp(factor * d2) * inverse[j];
          weight += p;
          mean += p * target[j];
          square += p * d2;
        }
        result.weight[i] = weight;
        result.target[i] = weight > 0 ? Vec3(mean / weight) : source[i];
        squares[i] = square;
      },
      32);
  result.total = result.variance = 0;
  for (std::size_t i = 0; i < n; ++i) {
    result.total += result.weight[i];
    result.variance += squares[i];
  }
  result.variance /= 3 * std::max(result.total, 1e-300);
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_SOFT_MATCHES_H
