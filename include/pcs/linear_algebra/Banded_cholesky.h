// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Symmetric positive definite systems of small bandwidth: assembled, factorised and solved in place.

#ifndef PCS_LINEAR_ALGEBRA_BANDED_CHOLESKY_H
#define PCS_LINEAR_ALGEBRA_BANDED_CHOLESKY_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace linear_algebra {

/// A symmetric matrix with `Bandwidth` diagonals below the main one, kept as rows of the lower half.
template <std::size_t Bandwidth>
class Banded_cholesky
{
public:
  /// Becomes the zero matrix of size `n`.
  void reset(std::size_t n)
  {
    m_size = n;
    m_columns.assign((n + Bandwidth) * width, 0.0);
  }

  std::size_t size() const { return m_size; }

  /// Entry of the lower half: `j <= i <= j + Bandwidth`.
  double& operator()(std::size_t i, std::size_t j) { return m_columns[j * width + (i - j)]; }
  double operator()(std::size_t i, std::size_t j) const { return m_columns[j * width + (i - j)]; }

  /// Replaces the matrix by its factor. `false` if it is not positive definite.
  bool factorize()
  {
    for (std::size_t j = 0; j < m_size; ++j) {
      double* column = &m_columns[j * width];
      if (!(column[0] > 0 && std::isfinite(column[0])))
        return false;
      column[0] = std::sqrt(column[0]);
      const double inverse = 1 / column[0];
      for (std::size_t i = 1; i < width; ++i)
        column[i] *= inverse;
      // its share of the columns behind it; loops of fixed lengths over neighbouring numbers
      for (std::size_t k = 1; k < width; ++k) {
        double* other = column + k * width;
        const double factor = column[k];
        for (std::size_t i = 0; i < width - k; ++i)
          other[i] -= factor * column[k + i];
      }
    }
    return true;
  }

  /// Solves in place, after `factorize()`.
  void solve(std::vector<double>& x) const
  {
    for (std::size_t j = 0; j < m_size; ++j) {
      const double* column = &m_columns[j * width];
      x[j] /= column[0];
      const std::size_t count = std::min(width, m_size - j);
      for (std::size_t i = 1; i < count; ++i)
        x[j + i] -= column[i] * x[j];
    }
    for (std::size_t j = m_size; j-- > 0;) {
      const double* column = &m_columns[j * width];
      const std::size_t count = std::min(width, m_size - j);
      for (std::size_t i = 1; i < count; ++i)
        x[j] -= column[i] * x[j + i];
      x[j] /= column[0];
    }
  }

  /*!
    The diagonal of the inverse, after `factorize()`. O(size Bandwidth^2): of the inverse only the band is computed, from
    the last row upwards (Takahashi's recurrence).
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
      const double pivot = 1 / (*this)(i, i);
      for (std::size_t j = end; j-- > i + 1;) {
        double sum = 0;
        for (std::size_t k = i + 1; k < end; ++k)
          sum += (*this)(k, i) * at(k, j);
        at(i, j) = -pivot * sum;
      }
      double sum = 0;
      for (std::size_t k = i + 1; k < end; ++k)
        sum += (*this)(k, i) * at(i, k);
      diagonal[i] = at(i, i) = pivot * (pivot - sum);
    }
    return diagonal;
  }

private:
  static constexpr std::size_t width = Bandwidth + 1;
  std::size_t m_size = 0;
  std::vector<double> m_columns; // each from its diagonal downwards; behind the last ones, zeros
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_BANDED_CHOLESKY_H
