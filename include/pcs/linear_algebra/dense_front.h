// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The dense part of a sparse Cholesky factorisation: one panel at a time.

#ifndef PCS_LINEAR_ALGEBRA_DENSE_FRONT_H
#define PCS_LINEAR_ALGEBRA_DENSE_FRONT_H

#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <algorithm>
#include <cstddef>
#include <functional>

namespace pcs {
namespace linear_algebra {

/// A matrix stored by columns.
struct Dense_columns
{
  double* value;
  std::size_t stride; ///< from column to column

  double* at(std::size_t row, std::size_t column) const { return value + row + column * stride; }
};

/*!
  A panel of `width` columns and `height` rows during a factorisation.

  The diagonal is stored separately. If updates were first added up, small values would be lost
  against large ones.
*/
struct Front
{
  /// Input: the matrix with the updates of the children. Output: `D` on the diagonal, `L` below.
  Dense_columns panel;
  /// Output: `L D`.
  Dense_columns scaled;
  std::size_t height, width;
  /// Square matrix of size `height - width`; the update for the rows below is subtracted from its
  /// lower triangle.
  Dense_columns rest;
  /// Current values for the panel's own rows, and for the rows below.
  double *diagonal, *diagonal_below;
  /// Whether `diagonal` and `diagonal_below` are sums of rows, see `Sparse_cholesky::factorize()`.
  bool has_row_sums;
  /// Called after some work; if it returns `false`, the factorisation fails. May be null.
  const std::function<bool()>* go_on = nullptr;
};

/// Number of products of two numbers between two calls of `go_on`: 3 to 50 ms of work. [count]
constexpr double products_between_calls = 1e8;

namespace internal {

/// Arithmetic for machines without a fused multiply-add.
struct Plain_arithmetic
{
  using Doubles = pcs::internal::Double4;

  static PCS_ALWAYS_INLINE void fill(const double& x, Doubles& z) { pcs::internal::fill(x, z); }
  template <class Lanes>
  static PCS_ALWAYS_INLINE void subtract_product(const Lanes& x, const Lanes& y, Lanes& z)
  {
    z = z - x * y;
  }
};

/// Two matrices with the same number of columns; rows of the left matrix are multiplied by rows
/// of the right matrix.
struct Dense_product
{
  Dense_columns left, right;
};

/// Computes `c -= left(rows) right(columns)^T` over `count` columns of both matrices, for `Vectors`
/// registers of rows from `row` on. `c` has `Columns` columns, the first of which belongs to row
/// `column` of the right matrix.
template <class Arithmetic, class Lanes, std::size_t Vectors, std::size_t Columns>
PCS_ALWAYS_INLINE void subtract_tile(const Dense_product& l,
                                     std::size_t row,
                                     std::size_t column,
                                     std::size_t count,
                                     double* c,
                                     std::size_t stride)
{
  using pcs::internal::unroll;
  constexpr std::size_t width = sizeof(Lanes) / sizeof(double);
  Lanes sum[Vectors * Columns];
  unroll<Vectors * Columns>([&](auto k) PCS_LAMBDA_INLINE {
    pcs::internal::load(c + k / Columns * width + k % Columns * stride, sum[k]);
  });
  const double *a = l.left.at(row, 0), *b = l.right.at(column, 0);
  for (std::size_t k = 0; k < count; ++k, a += l.left.stride, b += l.right.stride) {
    Lanes rows[Vectors], factor;
    unroll<Vectors>([&](auto v) PCS_LAMBDA_INLINE { pcs::internal::load(a + v * width, rows[v]); });
    unroll<Columns>([&](auto j) PCS_LAMBDA_INLINE {
      Arithmetic::fill(b[j], factor);
      unroll<Vectors>([&](auto v) PCS_LAMBDA_INLINE {
        Arithmetic::subtract_product(rows[v], factor, sum[v * Columns + j]);
      });
    });
  }
  unroll<Vectors * Columns>([&](auto k) PCS_LAMBDA_INLINE {
    pcs::internal::store(sum[k], c + k / Columns * width + k % Columns * stride);
  });
}

/// Applies the same product to the rows from `row` to `end`, with large tiles first. The order
/// of summation of an entry does not depend on the tile.
template <class Arithmetic, std::size_t Columns>
PCS_ALWAYS_INLINE void subtract_strip(const Dense_product& l,
                                      std::size_t row,
                                      std::size_t end,
                                      std::size_t column,
                                      std::size_t count,
                                      double* c,
                                      std::size_t stride)
{
  using Doubles = typename Arithmetic::Doubles;
  constexpr std::size_t width = sizeof(Doubles) / sizeof(double);
  for (; row + 2 * width <= end; row += 2 * width, c += 2 * width)
    subtract_tile<Arithmetic, Doubles, 2, Columns>(l, row, column, count, c, stride);
  for (; row + width <= end; row += width, c += width)
    subtract_tile<Arithmetic, Doubles, 1, Columns>(l, row, column, count, c, stride);
  for (; row < end; ++row, ++c)
    for (std::size_t j = 0; j < Columns; ++j) {
      double sum = c[j * stride];
      for (std::size_t k = 0; k < count; ++k)
        Arithmetic::subtract_product(*l.left.at(row, k), *l.right.at(column + j, k), sum);
      c[j * stride] = sum;
    }
}

/// Returns the sum of some entries. The order of summation is that of four lanes.
PCS_ALWAYS_INLINE double sum_of(const double* begin, const double* end)
{
  double sum[4] = {0, 0, 0, 0};
  for (; begin + 4 <= end; begin += 4)
    for (std::size_t k = 0; k < 4; ++k)
      sum[k] += begin[k];
  for (std::size_t k = 0; begin < end; ++begin, ++k)
    sum[k] += *begin;
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// Factorises a panel in place and subtracts its update from the rows below. Returns `false` if a
/// pivot is not positive, or if `go_on` does.
template <class Arithmetic>
PCS_ALWAYS_INLINE bool factorize_front(const Front& front)
{
  const Dense_columns &panel = front.panel, &scaled = front.scaled, &rest = front.rest;
  const std::size_t height = front.height, width = front.width;
  constexpr std::size_t strip = 4;
  const Dense_product all{panel, scaled};
  double products = 0; // since the last call
  const auto goes_on = [&](std::size_t rows, std::size_t columns, std::size_t count) {
    products += static_cast<double>(rows) * static_cast<double>(columns * count);
    if (!front.go_on || products < products_between_calls)
      return true;
    products = 0;
    return (*front.go_on)();
  };
  // Updates the columns from `begin` to `end` of `c`, which begins at entry (first, first).
  const auto subtract = [&](std::size_t begin,
                            std::size_t end,
                            std::size_t first,
                            std::size_t count,
                            const Dense_columns& c) PCS_LAMBDA_INLINE {
    std::size_t j = begin;
    for (; j + strip <= end; j += strip) {
      subtract_strip<Arithmetic, strip>(all,
                                        first + j,
                                        height,
                                        first + j,
                                        count,
                                        c.at(j, j),
                                        c.stride);
      if (!goes_on(height - first - j, strip, count))
        return false;
    }
    for (; j < end; ++j)
      subtract_strip<Arithmetic, 1>(all, first + j, height, first + j, count, c.at(j, j), c.stride);
    return true;
  };
  for (std::size_t begin = 0; begin < width; begin += strip) {
    const std::size_t end = std::min(width, begin + strip);
    if (!subtract(begin, end, 0, begin, panel))
      return false;
    const Dense_product own{{panel.at(0, begin), panel.stride},
                            {scaled.at(0, begin), scaled.stride}};
    for (std::size_t j = begin; j < end; ++j) {
      subtract_strip<Arithmetic, 1>(own, j, height, j, j - begin, panel.at(j, j), panel.stride);
      double *column = panel.at(0, j), *unscaled = scaled.at(0, j);
      const double own_value = front.diagonal[j];
      const double pivot = column[j] =
          front.has_row_sums ? own_value - sum_of(column + j + 1, column + height) : own_value;
      if (!(pivot > 0))
        return false;
      for (std::size_t i = j + 1; i < height; ++i) {
        unscaled[i] = column[i];
        column[i] /= pivot;
      }
      if (front.has_row_sums) {
        for (std::size_t i = j + 1; i < width; ++i)
          Arithmetic::subtract_product(column[i], own_value, front.diagonal[i]);
        for (std::size_t i = width; i < height; ++i)
          Arithmetic::subtract_product(column[i], own_value, front.diagonal_below[i - width]);
      } else {
        for (std::size_t i = j + 1; i < width; ++i)
          Arithmetic::subtract_product(column[i], unscaled[i], front.diagonal[i]);
        for (std::size_t i = width; i < height; ++i)
          Arithmetic::subtract_product(column[i], unscaled[i], front.diagonal_below[i - width]);
      }
    }
  }
  return subtract(0, height - width, width, width, rest);
}

inline bool factorize_front_default(const Front& front)
{
  return factorize_front<Plain_arithmetic>(front);
}

#if PCS_HAS_RUNTIME_DISPATCH
PCS_TARGET_AVX2 inline bool factorize_front_avx2(const Front& front)
{
  return factorize_front<pcs::internal::Avx2_arithmetic>(front);
}

PCS_TARGET_AVX512 inline bool factorize_front_avx512(const Front& front)
{
  return factorize_front<pcs::internal::Avx512_arithmetic>(front);
}
#endif

} // namespace internal

using Factorize_front = bool (*)(const Front&);

/// Returns the kernel for this machine. Kernels with a fused multiply-add give the same bits.
inline Factorize_front choose_factorize_front()
{
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx512())
    return &internal::factorize_front_avx512;
  if (pcs::internal::has_avx2())
    return &internal::factorize_front_avx2;
#endif
  return &internal::factorize_front_default;
}

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_DENSE_FRONT_H
