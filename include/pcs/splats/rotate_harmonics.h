// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotation of the coefficients of real spherical harmonics.

#ifndef PCS_SPLATS_ROTATE_HARMONICS_H
#define PCS_SPLATS_ROTATE_HARMONICS_H

#include <pcs/core/errors.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/splats/spherical_harmonics.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <cstddef>
#include <string>

namespace pcs {
namespace splats {

/*!
  A colour that turns with its splat has, in the direction `d`, the value that it had in the
  direction `R^T d` before. Each band is closed under rotations. With `n = 2 l + 1` directions `d_i`
  at which the functions `Y_j` of the band `l` are independent, the new coefficients `k'` follow
  from the old ones `k`:

      sum_j Y_j(d_i) k'_j = sum_j Y_j(R^T d_i) k_j,  i = 1 .. n,
      k' = B^-1 V k,  B_ij = Y_j(d_i),  V_ij = Y_j(R^T d_i)

  This is exact up to rounding. The idea of fixed directions is that of [Nowrouzezahrai, Simari and
  Fiume, "Sparse zonal harmonic factorization for efficient SH rotation", 2012]. The directions here
  were selected from those with small integer coordinates so that `|B| |B^-1| / n`, with the norms
  of Frobenius, is small: 1.1 for band 2, 1.2 for band 3 and 1.4 for band 4; 1 is the least.
*/
namespace internal {

/// `2 Band + 1` directions, not normalised.
template <int Band>
struct Sample_directions;
template <>
struct Sample_directions<2>
{
  static constexpr int value[5][3] = {{-1, 2, 1}, {1, 0, 0}, {-2, 2, -1}, {1, 1, 1}, {1, 2, 0}};
};
template <>
struct Sample_directions<3>
{
  static constexpr int value[7][3] =
      {{0, 0, 1}, {0, -2, 1}, {-1, 2, 1}, {0, 1, 1}, {-1, -1, 2}, {1, 2, 0}, {-2, 1, 2}};
};
template <>
struct Sample_directions<4>
{
  static constexpr int value[9][3] = {{-1, 1, 1},
                                      {-1, 2, 1},
                                      {-2, 1, 0},
                                      {1, 2, 1},
                                      {0, -1, 1},
                                      {2, 1, 0},
                                      {2, 1, 1},
                                      {0, 1, 0},
                                      {-2, 0, -1}};
};

/// The directions as unit vectors, and `B^-1`.
template <int Band>
struct Band_samples
{
  static constexpr int n = 2 * Band + 1;
  double direction[n][3];
  double inverse[n][n];

  Band_samples()
  {
    Eigen::Matrix<double, n, n> b;
    for (int i = 0; i < n; ++i) {
      const int* v = Sample_directions<Band>::value[i];
      const Eigen::Vector3d d = Eigen::Vector3d(v[0], v[1], v[2]).normalized();
      double values[n];
      evaluate_band<Band>(d.x(), d.y(), d.z(), values);
      for (int j = 0; j < 3; ++j)
        direction[i][j] = d[j];
      for (int j = 0; j < n; ++j)
        b(i, j) = values[j];
    }
    const Eigen::Matrix<double, n, n> inverse_of_b = b.partialPivLu().inverse();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        inverse[i][j] = inverse_of_b(i, j);
  }

  static const Band_samples& instance()
  {
    static const Band_samples samples;
    return samples;
  }
};

/// Rotates one band of three channels. `r` is the rotation, row by row; the coefficients of channel
/// `c` begin at `in[c * stride]`. `in` and `out` may be the same.
template <int Band, class T>
PCS_ALWAYS_INLINE void rotate_band(const T* r, int stride, const T* in, T* out)
{
  if constexpr (Band == 1) { // Y_1 = c (-y, z, -x): the coefficients are those of a vector
    for (int c = 0; c < 3; ++c, in += stride, out += stride) {
      const T x = -in[2], y = -in[0], z = in[1];
      out[0] = -(r[3] * x + r[4] * y + r[5] * z);
      out[1] = r[6] * x + r[7] * y + r[8] * z;
      out[2] = -(r[0] * x + r[1] * y + r[2] * z);
    }
  } else {
    constexpr int n = 2 * Band + 1;
    const Band_samples<Band>& samples = Band_samples<Band>::instance();
    T sampled[3][n];
    for (int i = 0; i < n; ++i) {
      const double* d = samples.direction[i];
      T turned[3], values[n];
      for (int j = 0; j < 3; ++j)
        turned[j] = d[0] * r[j] + d[1] * r[3 + j] + d[2] * r[6 + j];
      evaluate_band<Band>(turned[0], turned[1], turned[2], values);
      for (int c = 0; c < 3; ++c) {
        T sum = values[0] * in[c * stride];
        for (int j = 1; j < n; ++j)
          sum += values[j] * in[c * stride + j];
        sampled[c][i] = sum;
      }
    }
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < n; ++i) {
        T sum = samples.inverse[i][0] * sampled[c][0];
        for (int j = 1; j < n; ++j)
          sum += samples.inverse[i][j] * sampled[c][j];
        out[c * stride + i] = sum;
      }
  }
}

/// Rotates the bands 1 to `degree` of three channels, as `rotate_band()`.
template <class T>
PCS_ALWAYS_INLINE void rotate_bands(const T* r, int degree, const T* in, T* out)
{
  const int stride = number_of_coefficients(degree) - 1;
  if (degree >= 1)
    rotate_band<1>(r, stride, in, out);
  if (degree >= 2)
    rotate_band<2>(r, stride, in + 3, out + 3);
  if (degree >= 3)
    rotate_band<3>(r, stride, in + 8, out + 8);
  if (degree >= 4)
    rotate_band<4>(r, stride, in + 15, out + 15);
}

/// Largest number of coefficients of three channels without the constants.
constexpr int most_coefficients = 3 * (number_of_coefficients(largest_degree) - 1);

} // namespace internal

//! returns the number of the properties `f_rest_0`, ... of a splat: `3 ((degree + 1)^2 - 1)`
constexpr std::size_t number_of_rest_coefficients(int degree)
{
  return static_cast<std::size_t>(3 * (number_of_coefficients(degree) - 1));
}

/*!
  \ingroup PkgPcsDeformationRef
  \brief returns the degree that has `count` coefficients `f_rest_0`, ...

  \throws Invalid_input unless `count` is 0, 9, 24, 45 or 72
*/
inline int degree_of_harmonics(std::size_t count)
{
  for (int degree = 0; degree <= largest_degree; ++degree)
    if (count == number_of_rest_coefficients(degree))
      return degree;
  throw Invalid_input(
      "splats of degree d have 3 ((d + 1)^2 - 1) coefficients f_rest_0, f_rest_1, ...: 0, 9, 24, "
      "45 or 72 for the degrees 0 to 4; there are " +
      std::to_string(count));
}

/*!
  \ingroup PkgPcsDeformationRef
  \brief rotates the colours of a splat.

  Afterwards the colour in the direction `rotation * d` is the one that was in the direction `d`.
  The calculation is in double precision.

  \tparam FT `float` or `double`
  \param rotation a rotation matrix
  \param degree 0 to `largest_degree`
  \param coefficients `number_of_rest_coefficients(degree)` values in the order of splat files: all
         of red without the constant one, then green, then blue; modified in place
  \throws Invalid_input if the degree is out of range
  \par Complexity
  About 1500 arithmetic operations for degree 3.
*/
template <class FT>
void rotate_harmonics(const Eigen::Matrix3d& rotation, int degree, FT* coefficients)
{
  if (degree < 0 || degree > largest_degree)
    throw Invalid_input("pcs::splats::rotate_harmonics(): the degree is " + std::to_string(degree) +
                        ", but it must be 0 to " + std::to_string(largest_degree));
  double r[9], values[internal::most_coefficients];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r[3 * i + j] = rotation(i, j);
  const std::size_t count = number_of_rest_coefficients(degree);
  for (std::size_t i = 0; i < count; ++i)
    values[i] = static_cast<double>(coefficients[i]);
  internal::rotate_bands(r, degree, values, values);
  for (std::size_t i = 0; i < count; ++i)
    coefficients[i] = static_cast<FT>(values[i]);
}

} // namespace splats
} // namespace pcs

#endif // PCS_SPLATS_ROTATE_HARMONICS_H
