// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Real spherical harmonics of the colours of Gaussian splats.

#ifndef PCS_SPLATS_SPHERICAL_HARMONICS_H
#define PCS_SPLATS_SPHERICAL_HARMONICS_H

#include <pcs/internal/instruction_set.h>

namespace pcs {
namespace splats {

/*!
  The colour of a splat in the unit direction `d`, from the camera to the splat, is

      c(d) = 1/2 + sum_{l <= degree} sum_{m = -l .. l} k_lm Y_lm(d)

  for each of red, green and blue \cite kerbl2023. The functions `Y_lm` of a band `l` are in the
  order of `m`. Their signs are those of the files: (-1)^m times the real spherical harmonics that
  are positive where the polynomials x, y, z, xy, ... of the direction are. For example, `Y_1 =
  sqrt(3 / (4 pi)) (-y, z, -x)`.
*/

//! the largest band of the functions below
constexpr int largest_degree = 4;

//! returns the number of coefficients of one colour channel in the bands 0 to `degree`
constexpr int number_of_coefficients(int degree)
{
  return (degree + 1) * (degree + 1);
}

namespace internal {

// Polynomials of degree l that are harmonic, written for x^2 + y^2 + z^2 = 1.

template <class T>
PCS_ALWAYS_INLINE void band_1(const T& x, const T& y, const T& z, T* values)
{
  constexpr double c = 0.48860251190291992159; // sqrt(3 / (4 pi))
  values[0] = -c * y;
  values[1] = c * z;
  values[2] = -c * x;
}

template <class T>
PCS_ALWAYS_INLINE void band_2(const T& x, const T& y, const T& z, T* values)
{
  constexpr double c1 = 1.0925484305920790705;  // sqrt(15 / (4 pi))
  constexpr double c2 = 0.31539156525252000603; // sqrt(5 / (16 pi))
  constexpr double c3 = 0.54627421529603953527; // sqrt(15 / (16 pi))
  values[0] = c1 * (x * y);
  values[1] = -c1 * (y * z);
  values[2] = c2 * (3.0 * (z * z) - 1.0);
  values[3] = -c1 * (x * z);
  values[4] = c3 * (x * x - y * y);
}

template <class T>
PCS_ALWAYS_INLINE void band_3(const T& x, const T& y, const T& z, T* values)
{
  constexpr double c1 = 0.59004358992664351035; // sqrt(35 / (32 pi))
  constexpr double c2 = 2.8906114426405540554;  // sqrt(105 / (4 pi))
  constexpr double c3 = 0.45704579946446573616; // sqrt(21 / (32 pi))
  constexpr double c4 = 0.37317633259011539141; // sqrt(7 / (16 pi))
  constexpr double c5 = 1.4453057213202770277;  // sqrt(105 / (16 pi))
  const T xx = x * x, yy = y * y, zz = z * z, outer = 5.0 * zz - 1.0;
  values[0] = -c1 * (y * (3.0 * xx - yy));
  values[1] = c2 * (x * y * z);
  values[2] = -c3 * (y * outer);
  values[3] = c4 * (z * (5.0 * zz - 3.0));
  values[4] = -c3 * (x * outer);
  values[5] = c5 * (z * (xx - yy));
  values[6] = -c1 * (x * (xx - 3.0 * yy));
}

template <class T>
PCS_ALWAYS_INLINE void band_4(const T& x, const T& y, const T& z, T* values)
{
  constexpr double c1 = 2.5033429417967045383;  // 3 / 4 sqrt(35 / pi)
  constexpr double c2 = 1.7701307697799305310;  // 3 / 4 sqrt(35 / (2 pi))
  constexpr double c3 = 0.94617469575756001809; // 3 / 4 sqrt(5 / pi)
  constexpr double c4 = 0.66904654355728916795; // 3 / 4 sqrt(5 / (2 pi))
  constexpr double c5 = 0.10578554691520430380; // 3 / 16 sqrt(1 / pi)
  constexpr double c6 = 0.47308734787878000905; // 3 / 8 sqrt(5 / pi)
  constexpr double c7 = 0.62583573544917613459; // 3 / 16 sqrt(35 / pi)
  const T xx = x * x, yy = y * y, zz = z * z;
  const T middle = 7.0 * zz - 1.0, outer = 7.0 * zz - 3.0, difference = xx - yy;
  values[0] = c1 * (x * y * difference);
  values[1] = -c2 * (y * z * (3.0 * xx - yy));
  values[2] = c3 * (x * y * middle);
  values[3] = -c4 * (y * z * outer);
  values[4] = c5 * (zz * (35.0 * zz - 30.0) + 3.0);
  values[5] = -c4 * (x * z * outer);
  values[6] = c6 * (difference * middle);
  values[7] = -c2 * (x * z * (xx - 3.0 * yy));
  values[8] = c7 * (difference * difference - 4.0 * (xx * yy));
}

} // namespace internal

/*!
  \ingroup PkgPcsDeformationRef
  \brief computes the functions of one band in the unit direction `(x, y, z)`.

  \tparam Band 0 to `largest_degree`
  \tparam T `double`, `float`, or vectors of them with arithmetic operators
  \param values receives `2 Band + 1` values [-]
*/
template <int Band, class T>
PCS_ALWAYS_INLINE void evaluate_band(const T& x, const T& y, const T& z, T* values)
{
  static_assert(Band >= 0 && Band <= largest_degree,
                "pcs::splats::evaluate_band(): the band must be 0 to 4");
  if constexpr (Band == 0)
    values[0] = 0.0 * x + 0.28209479177387814347; // sqrt(1 / (4 pi))
  else if constexpr (Band == 1)
    internal::band_1(x, y, z, values);
  else if constexpr (Band == 2)
    internal::band_2(x, y, z, values);
  else if constexpr (Band == 3)
    internal::band_3(x, y, z, values);
  else
    internal::band_4(x, y, z, values);
}

} // namespace splats
} // namespace pcs

#endif // PCS_SPLATS_SPHERICAL_HARMONICS_H
