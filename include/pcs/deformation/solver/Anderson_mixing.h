// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Anderson acceleration of a fixed-point iteration on vectors of small vectors.

#ifndef PCS_DEFORMATION_SOLVER_ANDERSON_MIXING_H
#define PCS_DEFORMATION_SOLVER_ANDERSON_MIXING_H

#include <pcs/internal/parallel.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  For the iteration `x <- g(x)`, proposes the combination of the last few `g(x_j)` that minimises
  the combined residual of the `g(x_j) - x_j` (D. G. Anderson 1965; H. F. Walker, P. Ni, SIAM J.
  Numer. Anal. 49, 2011). Memory: `2 depth` vectors, in single precision if they are long: they are
  differences, whose relative errors of 1e-7 matter little.
*/
template <class ConcurrencyTag>
class Anderson_mixing
{
public:
  using Vec3 = Eigen::Vector3d;
  static constexpr std::size_t depth = 5;
  /// Longest vectors of which differences are stored in double precision. [count]
  static constexpr std::size_t most_exact_entries = 65536;

  /// Discards all earlier iterates; their memory is reused.
  void restart()
  {
    m_count = 0;
    m_has_last = false;
  }

  /// Stores `x` and `g = g(x)`. If `is_wanted`, replaces `g` by the proposal.
  void mix(const std::vector<Vec3>& x, std::vector<Vec3>& g, bool is_wanted = true)
  {
    const std::size_t n = x.size(), slot = m_count % depth;
    m_last_residual.resize(n);
    m_last_image.resize(n);
    if (!m_has_last) { // no earlier iterate for differences
      m_has_last = true;
      pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
        m_last_residual[i] = g[i] - x[i];
        m_last_image[i] = g[i];
      });
      return;
    }
    if (n > most_exact_entries)
      mix_with(m_short, slot, x, g, is_wanted);
    else
      mix_with(m_exact, slot, x, g, is_wanted);
  }

private:
  /// Differences of the last residuals and images.
  template <class Scalar>
  struct Differences
  {
    using Vector = Eigen::Matrix<Scalar, 3, 1>;
    std::vector<Vector> residual[depth], image[depth];

    static Vector rounded(const Vec3& v) { return v.template cast<Scalar>(); }
  };

  template <class Scalar>
  void mix_with(Differences<Scalar>& differences,
                std::size_t slot,
                const std::vector<Vec3>& x,
                std::vector<Vec3>& g,
                bool is_wanted)
  {
    auto &of_residuals = differences.residual[slot], &of_images = differences.image[slot];
    of_residuals.resize(x.size());
    of_images.resize(x.size());
    pcs::internal::for_each_index<ConcurrencyTag>(x.size(), [&](std::size_t i) {
      const Vec3 residual = g[i] - x[i];
      of_residuals[i] = differences.rounded(residual - m_last_residual[i]);
      of_images[i] = differences.rounded(g[i] - m_last_image[i]);
      m_last_residual[i] = residual;
      m_last_image[i] = g[i];
    });
    ++m_count;
    const std::size_t size = std::min(m_count, depth);
    const Products products = multiply(differences, slot, size);
    for (std::size_t a = 0; a < size; ++a)
      m_normal[a][slot] = m_normal[slot][a] = products.with_new[a];
    if (is_wanted)
      propose(differences, size, products.with_residual, g);
  }

  /// Dot products of the differences of residuals with the newest difference and the last residual.
  struct Products
  {
    std::array<double, depth> with_new{}, with_residual{};
  };

  template <class Scalar>
  Products multiply(const Differences<Scalar>& differences, std::size_t slot, std::size_t size)
  {
    return pcs::internal::blocked_reduce<ConcurrencyTag>(
        m_last_residual.size(),
        Products(),
        [&](std::size_t i) {
          Products p;
          for (std::size_t a = 0; a < size; ++a) {
            const Vec3 difference = differences.residual[a][i].template cast<double>();
            p.with_new[a] = difference.dot(differences.residual[slot][i].template cast<double>());
            p.with_residual[a] = difference.dot(m_last_residual[i]);
          }
          return p;
        },
        [](Products a, const Products& b) {
          for (std::size_t k = 0; k < depth; ++k) {
            a.with_new[k] += b.with_new[k];
            a.with_residual[k] += b.with_residual[k];
          }
          return a;
        },
        pcs::internal::default_block,
        m_products);
  }

  template <class Scalar>
  void propose(const Differences<Scalar>& differences,
               std::size_t size,
               const std::array<double, depth>& with_residual,
               std::vector<Vec3>& g) const
  {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, depth, depth>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, depth, 1>;
    const auto rows = static_cast<Eigen::Index>(size);
    Matrix normal(rows, rows);
    Vector right(rows);
    for (Eigen::Index a = 0; a < rows; ++a) {
      right[a] = with_residual[static_cast<std::size_t>(a)];
      for (Eigen::Index b = 0; b < rows; ++b)
        normal(a, b) = m_normal[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    }
    // The differences become parallel near the solution; 1e-10 bounds the coefficients.
    normal.diagonal().array() += 1e-10 * normal.trace() + 1e-300;
    const Vector gamma = normal.ldlt().solve(right);
    if (!gamma.allFinite())
      return;
    pcs::internal::for_each_index<ConcurrencyTag>(g.size(), [&](std::size_t i) {
      for (std::size_t a = 0; a < size; ++a)
        g[i] -=
            gamma[static_cast<Eigen::Index>(a)] * differences.image[a][i].template cast<double>();
    });
  }

  std::vector<Vec3> m_last_residual, m_last_image;
  Differences<double> m_exact;
  Differences<float> m_short;
  std::vector<Products> m_products; ///< partial sums by block
  std::array<std::array<double, depth>, depth> m_normal{};
  std::size_t m_count = 0;
  bool m_has_last = false;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_ANDERSON_MIXING_H
