// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Anderson acceleration of a fixed-point iteration on vectors of small vectors.

#ifndef PCS_DEFORMATION_ANDERSON_MIXING_H
#define PCS_DEFORMATION_ANDERSON_MIXING_H

#include <pcs/internal/parallel.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  For the iteration `x <- g(x)`, proposes the combination of the last few `g(x_j)` whose residuals `g(x_j) - x_j`
  cancel best (D. G. Anderson 1965; H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49, 2011). Memory: `2 depth` vectors.
*/
template <class ConcurrencyTag>
class Anderson_mixing
{
public:
  using Vec3 = Eigen::Vector3d;
  static constexpr std::size_t depth = 5;

  /// Forgets what was seen. The memory is kept.
  void restart()
  {
    m_count = 0;
    m_has_last = false;
  }

  /// Replaces `g`, which is `g(x)`, by the proposal.
  void mix(const std::vector<Vec3>& x, std::vector<Vec3>& g)
  {
    const std::size_t n = x.size();
    m_residual.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      m_residual[i] = g[i] - x[i];
    if (m_has_last) {
      const std::size_t slot = m_count++ % depth;
      m_difference_of_residuals[slot].resize(n);
      m_difference_of_images[slot].resize(n);
      for (std::size_t i = 0; i < n; ++i) {
        m_difference_of_residuals[slot][i] = m_residual[i] - m_last_residual[i];
        m_difference_of_images[slot][i] = g[i] - m_last_image[i];
      }
    }
    m_last_residual = m_residual;
    m_last_image = g;
    m_has_last = true;
    const auto size = static_cast<Eigen::Index>(std::min(m_count, depth));
    if (size == 0)
      return;
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, depth, depth>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, depth, 1>;
    Matrix normal(size, size);
    Vector right(size);
    for (Eigen::Index a = 0; a < size; ++a) {
      right[a] = dot(m_difference_of_residuals[a], m_residual);
      for (Eigen::Index b = 0; b <= a; ++b)
        normal(a, b) = normal(b, a) =
            dot(m_difference_of_residuals[a], m_difference_of_residuals[b]);
    }
    // The differences become parallel near the solution; 1e-10 keeps the coefficients bounded.
    normal.diagonal().array() += 1e-10 * normal.trace() + 1e-300;
    const Vector gamma = normal.ldlt().solve(right);
    if (!gamma.allFinite())
      return;
    for (Eigen::Index a = 0; a < size; ++a)
      for (std::size_t i = 0; i < n; ++i)
        g[i] -= gamma[a] * m_difference_of_images[a][i];
  }

private:
  static double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
  {
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        a.size(),
        0.0,
        [&](std::size_t i) { return a[i].dot(b[i]); },
        std::plus<double>());
  }

  std::vector<Vec3> m_residual, m_last_residual, m_last_image;
  std::vector<Vec3> m_difference_of_residuals[depth], m_difference_of_images[depth];
  std::size_t m_count = 0;
  bool m_has_last = false;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ANDERSON_MIXING_H
