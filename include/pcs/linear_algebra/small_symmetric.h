// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Eigenvectors and solutions of small dense symmetric systems, in scalar loops. The blocked
// decompositions of Eigen would take half of the compile time of these headers.

#ifndef PCS_LINEAR_ALGEBRA_SMALL_SYMMETRIC_H
#define PCS_LINEAR_ALGEBRA_SMALL_SYMMETRIC_H

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pcs {
namespace linear_algebra {

/// Eigenvalues in ascending order, and their eigenvectors as orthonormal columns.
template <int N>
struct Symmetric_eigen
{
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};

namespace internal {

/// Rotates the axes `p < q` by the Jacobi rotation for which `a(p, q)` vanishes; `v` follows.
template <int N>
void rotate_axes(Eigen::Index p,
                 Eigen::Index q,
                 Eigen::Matrix<double, N, N>& a,
                 Eigen::Matrix<double, N, N>& v)
{
  const Eigen::Index n = a.rows();
  const double off = a(p, q);
  // tangent of the smaller angle for which a(p, q) vanishes
  const double half = 0.5 * (a(q, q) - a(p, p));
  const double t = (half < 0 ? -1 : 1) * off / (std::abs(half) + std::hypot(half, off));
  const double c = 1 / std::sqrt(1 + t * t), s = t * c;
  a(p, p) -= t * off;
  a(q, q) += t * off;
  a(p, q) = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (k != p && k != q) {
      double& kp = k < p ? a(k, p) : a(p, k);
      double& kq = k < q ? a(k, q) : a(q, k);
      const double old = kp;
      kp = c * old - s * kq;
      kq = s * old + c * kq;
    }
    const double old = v(k, p);
    v(k, p) = c * old - s * v(k, q);
    v(k, q) = s * old + c * v(k, q);
  }
}

/// Rotates all pairs of axes once. Returns `false` if `a` is diagonal up to rounding.
template <int N>
bool sweep_rotations(Eigen::Matrix<double, N, N>& a, Eigen::Matrix<double, N, N>& v)
{
  const Eigen::Index n = a.rows();
  bool is_diagonal = true;
  for (Eigen::Index p = 0; p < n; ++p)
    for (Eigen::Index q = p + 1; q < n; ++q) {
      const double size = std::abs(a(p, p)) + std::abs(a(q, q));
      if (std::abs(a(p, q)) <= 0.5 * std::numeric_limits<double>::epsilon() * size) {
        a(p, q) = 0;
        continue;
      }
      is_diagonal = false;
      rotate_axes(p, q, a, v);
    }
  return !is_diagonal;
}

/// Sorts eigenvalues in ascending order together with their eigenvectors.
template <int N>
void sort_eigenvalues(Symmetric_eigen<N>& eigen)
{
  const Eigen::Index n = eigen.values.size();
  for (Eigen::Index i = 0; i < n; ++i) { // n is small: by selection
    Eigen::Index least = i;
    for (Eigen::Index j = i + 1; j < n; ++j)
      if (eigen.values[j] < eigen.values[least])
        least = j;
    if (least == i)
      continue;
    std::swap(eigen.values[i], eigen.values[least]);
    for (Eigen::Index k = 0; k < n; ++k)
      std::swap(eigen.vectors(k, i), eigen.vectors(k, least));
  }
}

} // namespace internal

/*!
  Computes the eigenvalues and eigenvectors of a symmetric matrix by cyclic Jacobi rotations. Also
  for equal eigenvalues, the error is rounding relative to the largest eigenvalue. Both halves of
  `a` must be set. A matrix that is not finite has eigenvalues that are not finite. `N` may be
  `Eigen::Dynamic`. O(n^3) with about eight sweeps: meant for n up to a few hundred.
*/
template <int N>
Symmetric_eigen<N> symmetric_eigen(const Eigen::Matrix<double, N, N>& matrix)
{
  const Eigen::Index n = matrix.rows();
  Eigen::Matrix<double, N, N> a = matrix;
  Symmetric_eigen<N> result;
  result.values.resize(n);
  result.vectors.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      result.vectors(i, j) = i == j ? 1 : 0;

  constexpr int most_sweeps = 60; // for matrices that are not finite; others need fewer than ten
  for (int sweep = 0; sweep < most_sweeps; ++sweep)
    if (!internal::sweep_rotations(a, result.vectors))
      break;

  for (Eigen::Index i = 0; i < n; ++i)
    result.values[i] = a(i, i);
  internal::sort_eigenvalues(result);
  return result;
}

/*!
  Solves `a x = b` for a symmetric positive semi-definite `a` by `L D L^T` with the largest pivot
  first. Components in the null space of `a` (up to rounding) are set to 0. Sets `x` to 0 and
  returns `false` if a pivot is negative beyond rounding or a value is not finite. O(n^3).
*/
template <int N, int Columns>
bool solve_symmetric(const Eigen::Matrix<double, N, N>& matrix,
                     const Eigen::Matrix<double, N, Columns>& b,
                     Eigen::Matrix<double, N, Columns>& x)
{
  static_assert(N > 0, "small systems have a fixed size");
  Eigen::Matrix<double, N, N> a = matrix;
  x = b;
  int order[N];
  double largest = 0;
  for (int i = 0; i < N; ++i) {
    order[i] = i;
    largest = std::max(largest, std::abs(a(i, i)));
  }
  const double least = 4 * N * std::numeric_limits<double>::epsilon() * largest;
  bool is_solved = largest < std::numeric_limits<double>::infinity();
  int rank = 0;
  for (; rank < N && is_solved; ++rank) {
    int pivot = rank;
    for (int i = rank + 1; i < N; ++i)
      if (std::abs(a(i, i)) > std::abs(a(pivot, pivot)))
        pivot = i;
    if (pivot != rank) {
      std::swap(order[rank], order[pivot]);
      for (int k = 0; k < N; ++k)
        std::swap(a(rank, k), a(pivot, k));
      for (int k = 0; k < N; ++k)
        std::swap(a(k, rank), a(k, pivot));
      for (int k = 0; k < Columns; ++k)
        std::swap(x(rank, k), x(pivot, k));
    }
    const double d = a(rank, rank);
    if (!(std::abs(d) > least)) {
      is_solved = !std::isnan(d);
      break;
    }
    is_solved = d > 0;
    for (int i = rank + 1; i < N; ++i) {
      const double l = a(i, rank) / d;
      for (int k = rank + 1; k < N; ++k)
        a(i, k) -= l * a(rank, k);
      for (int k = 0; k < Columns; ++k)
        x(i, k) -= l * x(rank, k);
    }
  }
  for (int i = N; i-- > 0;)
    for (int k = 0; k < Columns; ++k) {
      double sum = 0;
      if (i < rank) {
        sum = x(i, k);
        for (int j = i + 1; j < rank; ++j)
          sum -= a(i, j) * x(j, k);
        sum /= a(i, i);
      }
      x(i, k) = sum;
      is_solved = is_solved && std::isfinite(sum);
    }
  Eigen::Matrix<double, N, Columns> sorted;
  for (int i = 0; i < N; ++i)
    for (int k = 0; k < Columns; ++k)
      sorted(order[i], k) = is_solved ? x(i, k) : 0;
  x = sorted;
  return is_solved;
}

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_SMALL_SYMMETRIC_H
