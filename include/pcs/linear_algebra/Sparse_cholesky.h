// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sparse Cholesky factor L D L^T with triangular solves for several right-hand sides at once.

#ifndef PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H
#define PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <cstddef>
#include <memory>
#include <vector>

namespace pcs {
namespace linear_algebra {

/*!
  Factor of a symmetric positive definite sparse matrix.

  The factor comes from Eigen; the solve is ours, because Eigen's goes over the factor once per right-hand side
  and the factor is what fills the caches. `solve()` is const, allocates nothing once the caller's work vector
  has grown, and may run concurrently with other solves.
*/
class Sparse_cholesky
{
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// Factorises `a`, of which only the lower triangle is read. Returns `false` if it is not positive definite.
  /// With `keep_pattern` the elimination order of the previous call is used again: same pattern, new values.
  bool factorize(const Matrix& a, bool keep_pattern = false)
  {
    m_size = static_cast<std::size_t>(a.rows());
    if (m_size == 0)
      return true;
    if (!m_ldlt)
      m_ldlt = std::make_unique<Ldlt>();
    if (!keep_pattern || m_ldlt->rows() != a.rows())
      m_ldlt->analyzePattern(a);
    m_ldlt->factorize(a);
    if (m_ldlt->info() != Eigen::Success)
      return false;
    m_inverse_diagonal = m_ldlt->vectorD().cwiseInverse();
    return m_inverse_diagonal.allFinite() && m_ldlt->vectorD().minCoeff() > 0;
  }

  std::size_t size() const { return m_size; }

  /// Number of entries of the factor below the diagonal.
  std::size_t number_of_nonzeros() const
  {
    return m_size == 0 ? 0 : static_cast<std::size_t>(factor().nonZeros());
  }

  /// Solves `A x = b` for right-hand sides stored row by row: `Row` is a fixed-size Eigen vector.
  template <class Row>
  void solve(std::vector<Row>& b, std::vector<Row>& work) const
  {
    if (m_size == 0)
      return;
    work.resize(m_size);
    const auto& to_factor = m_ldlt->permutationP().indices();
    for (std::size_t i = 0; i < m_size; ++i)
      work[static_cast<std::size_t>(to_factor[static_cast<Eigen::Index>(i)])] = b[i];

    const auto* first = factor().outerIndexPtr();
    const auto* row = factor().innerIndexPtr();
    const double* value = factor().valuePtr();
    for (std::size_t j = 0; j < m_size; ++j) {
      const Row x = work[j];
      for (auto p = first[j]; p < first[j + 1]; ++p)
        work[static_cast<std::size_t>(row[p])] -= value[p] * x;
      work[j] = x * m_inverse_diagonal[static_cast<Eigen::Index>(j)];
    }
    for (std::size_t j = m_size; j-- > 0;) {
      Row x = work[j];
      for (auto p = first[j]; p < first[j + 1]; ++p)
        x -= value[p] * work[static_cast<std::size_t>(row[p])];
      work[j] = x;
    }
    for (std::size_t i = 0; i < m_size; ++i)
      b[i] = work[static_cast<std::size_t>(to_factor[static_cast<Eigen::Index>(i)])];
  }

private:
  const Matrix& factor() const { return m_ldlt->matrixL().nestedExpression(); }

  using Ldlt = Eigen::SimplicialLDLT<Matrix, Eigen::Lower>;

  std::unique_ptr<Ldlt> m_ldlt; // Eigen's solvers cannot be moved
  Eigen::VectorXd m_inverse_diagonal;
  std::size_t m_size = 0;
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H
