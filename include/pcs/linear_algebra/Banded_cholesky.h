// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Symmetric positive definite systems of small bandwidth: assembled, factorised and solved in
// place.

#ifndef PCS_LINEAR_ALGEBRA_BANDED_CHOLESKY_H
#define PCS_LINEAR_ALGEBRA_BANDED_CHOLESKY_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace linear_algebra {

/// A symmetric matrix with `Bandwidth` diagonals below the main one; only the lower half is stored.
template <std::size_t Bandwidth>
class Banded_cholesky
{
public:
  /// Resets to the zero matrix of size `n`.
  void reset(std::size_t n)
  {
    m_size = n;
    m_columns.assign((n + Bandwidth) * width, 0.0);
  }

  std::size_t size() const { return m_size; }

  /// Returns an entry of the lower half: `j <= i <= j + Bandwidth`.
  double& operator()(std::size_t i, std::size_t j) { return m_columns[j * width + (i - j)]; }
  double operator()(std::size_t i, std::size_t j) const { return m_columns[j * width + (i - j)]; }

  /// Replaces the matrix by its factors L D L^T: the columns of L, with the inverses of D on the
  /// diagonal. Returns `false` if the matrix is not positive definite.
  bool factorize()
  {
    for (std::size_t j = 0; j < m_size; ++j) {
      double* column = &m_columns[j * width];
      if (!(column[0] > 0 && std::isfinite(column[0])))
        return false;
      const double inverse = 1 / column[0];
      std::array<double, width> scaled;
      for (std::size_t i = 1; i < width; ++i)
        scaled[i] = column[i] * inverse;
      take_out(scaled, column, std::make_index_sequence<Bandwidth>());
      for (std::size_t i = 1; i < width; ++i)
        column[i] = scaled[i];
      column[0] = inverse;
    }
    return true;
  }

  /// Solves in place, after `factorize()`.
  void solve(std::vector<double>& x) const
  {
    x.resize(m_size + Bandwidth, 0.0); // padded by zeros, because all columns have the same length
    for (std::size_t j = 0; j < m_size; ++j) {
      const double* column = &m_columns[j * width];
      for (std::size_t i = 1; i < width; ++i)
        x[j + i] -= column[i] * x[j];
    }
    for (std::size_t j = m_size; j-- > 0;) {
      const double* column = &m_columns[j * width];
      double sum = 0;
      for (std::size_t i = width - 1; i > 0; --i) // the value computed last is used last
        sum += column[i] * x[j + i];
      x[j] = column[0] * x[j] - sum;
    }
    x.resize(m_size);
  }

  /*!
    Returns the diagonal of the inverse, after `factorize()`. O(size Bandwidth^2): only the band of
    the inverse is computed, from the last row upwards (Takahashi's recurrence).
  */
  std::vector<double> inverse_diagonal() const
  {
    std::vector<double> diagonal(m_size);
    // entry (i, j) of the inverse, i <= j <= i + Bandwidth, for the last rows computed
    std::vector<double> band(width * width, 0.0);
    const auto at = [&](std::size_t i, std::size_t j) -> double& {
      return i <= j ? band[i % width * width + (j - i)] : band[j % width * width + (i - j)];
    };
    for (std::size_t i = m_size; i-- > 0;) {
      const std::size_t end = std::min(m_size, i + width);
      for (std::size_t j = end; j-- > i + 1;) {
        double sum = 0;
        for (std::size_t k = i + 1; k < end; ++k)
          sum += (*this)(k, i) * at(k, j);
        at(i, j) = -sum;
      }
      double sum = 0;
      for (std::size_t k = i + 1; k < end; ++k)
        sum += (*this)(k, i) * at(i, k);
      diagonal[i] = at(i, i) = (*this)(i, i) - sum;
    }
    return diagonal;
  }

private:
  static constexpr std::size_t width = Bandwidth + 1;

  /// Subtracts the update of a column from the next columns, in loops of constant length.
  template <std::size_t... K>
  static void
  take_out(const std::array<double, width>& scaled, double* column, std::index_sequence<K...>)
  {
    (take_out_of<K + 1>(scaled, column), ...);
  }
  template <std::size_t K>
  static void take_out_of(const std::array<double, width>& scaled, double* column)
  {
    double* other = column + K * width;
    const double factor = scaled[K];
    for (std::size_t i = 0; i < width - K; ++i)
      other[i] -= factor * column[K + i];
  }

  std::size_t m_size = 0;
  std::vector<double> m_columns; // each from its diagonal downwards, padded by zeros
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_BANDED_CHOLESKY_H
