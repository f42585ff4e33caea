// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotation fit of the local step (Kabsch, Wahba's problem), vectorised over nodes.

#ifndef PCS_DEFORMATION_SOLVER_FIT_ROTATIONS_H
#define PCS_DEFORMATION_SOLVER_FIT_ROTATIONS_H

#include <pcs/core/rotations.h>
#include <pcs/internal/instruction_set.h>
#include <pcs/internal/lanes.h>

#include <Eigen/Core>

#include <cstddef>

namespace pcs {
namespace deformation {

/*!
  Input and result of the rotation fits of up to `size` nodes, stored coordinate by coordinate.

  A fit maximises `tr(R^T C_i)` over rotations `R` (Kabsch, Wahba), which for fixed lengths
  minimises `sum_j w_ij |(x_j - x_i) - R (x0_j - x0_i)|^2`, with the covariance
  `C_i = sum_j w_ij (x_j - x_i) (x0_j - x0_i)^T` and the weights `w_ij` of the surface edges. One
  damped step of Newton's method is made from the current rotation.
*/
struct Rotation_fits
{
  static constexpr std::size_t size = 32;

  double covariance[9][size];              ///< column by column [L^2]
  double present[4][size], field[4][size]; ///< x, y, z, w
  double deviation[3][size];               ///< of the fit from the field [rad]

  Rotation_fits()
  {
    for (std::size_t k = 0; k < size; ++k)
      set(k, Eigen::Matrix3d::Zero(), Quaternion::Identity(), Quaternion::Identity());
  }

  void set(std::size_t k,
           const Eigen::Matrix3d& m,
           const Quaternion& present_one,
           const Quaternion& of_field)
  {
    for (std::size_t i = 0; i < 9; ++i)
      covariance[i][k] = m.data()[i];
    for (std::size_t i = 0; i < 4; ++i) {
      present[i][k] = present_one.coeffs().data()[i];
      field[i][k] = of_field.coeffs().data()[i];
    }
  }
};

namespace internal {

template <class Doubles>
PCS_ALWAYS_INLINE void absolute(const Doubles& x, Doubles& y)
{
  pcs::internal::select_less(x, Doubles{}, Doubles(-x), x, y);
}

/// Computes `covariance R^T` for the rotations `R` of unit quaternions, column by column.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void turn_back(const Doubles* covariance, const Doubles* q, Doubles* turned)
{
  using pcs::internal::unroll;
  const Doubles &x = q[0], &y = q[1], &z = q[2], &w = q[3];
  const Doubles twice_x = x + x, twice_y = y + y, twice_z = z + z;
  Doubles r[3][3]; // row by row
  Doubles one;
  pcs::internal::fill(1.0, one);
  r[0][0] = r[1][1] = r[2][2] = one;
  Arithmetic::subtract_product(twice_y, y, r[0][0]);
  Arithmetic::subtract_product(twice_z, z, r[0][0]);
  Arithmetic::subtract_product(twice_x, x, r[1][1]);
  Arithmetic::subtract_product(twice_z, z, r[1][1]);
  Arithmetic::subtract_product(twice_x, x, r[2][2]);
  Arithmetic::subtract_product(twice_y, y, r[2][2]);
  r[0][1] = r[1][0] = twice_x * y;
  r[0][2] = r[2][0] = twice_x * z;
  r[1][2] = r[2][1] = twice_y * z;
  Arithmetic::fma(twice_z, w, r[1][0]);
  Arithmetic::subtract_product(twice_z, w, r[0][1]);
  Arithmetic::fma(twice_y, w, r[0][2]);
  Arithmetic::subtract_product(twice_y, w, r[2][0]);
  Arithmetic::fma(twice_x, w, r[2][1]);
  Arithmetic::subtract_product(twice_x, w, r[1][2]);
  unroll<9>([&](auto k) PCS_LAMBDA_INLINE {
    constexpr std::size_t column = decltype(k)::value / 3, row = decltype(k)::value % 3;
    turned[k] = covariance[row] * r[column][0];
    Arithmetic::fma(covariance[3 + row], r[column][1], turned[k]);
    Arithmetic::fma(covariance[6 + row], r[column][2], turned[k]);
  });
}

/// Implements `pcs::newton_turn()`.
template <class Arithmetic, class Doubles>
PCS_ALWAYS_INLINE void newton_turn(const Doubles* m, double damping, Doubles* turn)
{
  using pcs::internal::select_less;
  using pcs::internal::unroll;
  const Doubles torque[3] = {m[5] - m[7], m[6] - m[2], m[1] - m[3]};
  const Doubles trace = m[0] + m[4] + m[8];
  Doubles size{}, absolute_trace, epsilon, all, none{};
  unroll<9>([&](auto k) PCS_LAMBDA_INLINE {
    Doubles a;
    absolute(m[k], a);
    size = size + a;
  });
  absolute(trace, absolute_trace);
  const Doubles damped = absolute_trace * damping, smallest = size * 1e-9;
  select_less(damped, smallest, smallest, damped, epsilon);
  pcs::internal::fill(1e-300, all);
  epsilon = epsilon + all;
  const Doubles xx = m[4] + m[8] + epsilon, yy = m[0] + m[8] + epsilon, zz = m[0] + m[4] + epsilon,
                xy = (m[1] + m[3]) * -0.5, xz = (m[2] + m[6]) * -0.5, yz = (m[5] + m[7]) * -0.5;
  // the adjugate of this Hessian
  Doubles axx = yy * zz, axy = xz * yz, axz = xy * yz, ayy = xx * zz, ayz = xy * xz, azz = xx * yy;
  Arithmetic::subtract_product(yz, yz, axx);
  Arithmetic::subtract_product(xy, zz, axy);
  Arithmetic::subtract_product(xz, yy, axz);
  Arithmetic::subtract_product(xz, xz, ayy);
  Arithmetic::subtract_product(xx, yz, ayz);
  Arithmetic::subtract_product(xy, xy, azz);
  Doubles determinant = xx * axx, inverse, squared;
  Arithmetic::fma(xy, axy, determinant);
  Arithmetic::fma(xz, axz, determinant);
  pcs::internal::fill(1.0, all);
  inverse = all / determinant;
  const Doubles* const adjugate[3][3] = {{&axx, &axy, &axz},
                                         {&axy, &ayy, &ayz},
                                         {&axz, &ayz, &azz}};
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE {
    turn[k] = *adjugate[k][0] * torque[0];
    Arithmetic::fma(*adjugate[k][1], torque[1], turn[k]);
    Arithmetic::fma(*adjugate[k][2], torque[2], turn[k]);
    turn[k] = turn[k] * inverse;
  });
  squared = turn[0] * turn[0];
  Arithmetic::fma(turn[1], turn[1], squared);
  Arithmetic::fma(turn[2], turn[2], squared);
  const Doubles step = all / (absolute_trace + epsilon);
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE {
    const Doubles other = torque[k] * step;
    select_less(squared, all, turn[k], other, turn[k]);
    select_less(none, determinant, turn[k], other, turn[k]);
    select_less(none, azz, turn[k], other, turn[k]);
    select_less(none, xx, turn[k], other, turn[k]);
  });
}

/// Fits the rotations of the lanes of one register, from `first` on.
template <class Arithmetic>
PCS_ALWAYS_INLINE void fit_lanes(double damping, std::size_t first, Rotation_fits& fits)
{
  using pcs::internal::load;
  using pcs::internal::unroll;
  using Doubles = typename Arithmetic::Doubles;
  Doubles covariance[9], p[4], f[4], turned[9], u[3];
  unroll<9>([&](auto k) PCS_LAMBDA_INLINE { load(fits.covariance[k] + first, covariance[k]); });
  unroll<4>([&](auto k) PCS_LAMBDA_INLINE {
    load(fits.present[k] + first, p[k]);
    load(fits.field[k] + first, f[k]);
  });
  turn_back<Arithmetic>(covariance, p, turned);
  newton_turn<Arithmetic>(turned, damping, u);
  // q = p f^-1
  Doubles q[4] = {p[0] * f[3], p[1] * f[3], p[2] * f[3], p[3] * f[3]};
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE {
    constexpr std::size_t i = decltype(k)::value, j = (i + 1) % 3, l = (i + 2) % 3;
    Arithmetic::subtract_product(p[3], f[i], q[i]);
    Arithmetic::subtract_product(p[j], f[l], q[i]);
    Arithmetic::fma(p[l], f[j], q[i]);
    Arithmetic::fma(p[i], f[i], q[3]);
  });
  // (1 + u / 2) q
  Doubles fit[4] = {q[0], q[1], q[2], q[3]}, squared, root, factor;
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE { u[k] = u[k] * 0.5; });
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE {
    constexpr std::size_t i = decltype(k)::value, j = (i + 1) % 3, l = (i + 2) % 3;
    Arithmetic::fma(u[i], q[3], fit[i]);
    Arithmetic::fma(u[j], q[l], fit[i]);
    Arithmetic::subtract_product(u[l], q[j], fit[i]);
    Arithmetic::subtract_product(u[i], q[i], fit[3]);
  });
  squared = fit[3] * fit[3];
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE { Arithmetic::fma(fit[k], fit[k], squared); });
  pcs::internal::reciprocal_root<Arithmetic>(squared, root);
  absolute(fit[3], factor);
  Arithmetic::fma(squared, root, factor); // |w| + |q|
  Doubles four;
  pcs::internal::fill(4.0, four);
  factor = four / factor;
  pcs::internal::select_less(fit[3], Doubles{}, Doubles(-factor), factor, factor);
  unroll<3>([&](auto k) PCS_LAMBDA_INLINE {
    pcs::internal::store(Doubles(fit[k] * factor), fits.deviation[k] + first);
  });
}

template <class Arithmetic>
PCS_ALWAYS_INLINE void fit_rotations(double damping, std::size_t count, Rotation_fits& fits)
{
  constexpr std::size_t step = sizeof(typename Arithmetic::Doubles) / sizeof(double);
  static_assert(Rotation_fits::size % step == 0);
  for (std::size_t first = 0; first < count; first += step)
    fit_lanes<Arithmetic>(damping, first, fits);
}

inline void fit_rotations_default(double damping, std::size_t count, Rotation_fits& fits)
{
  fit_rotations<pcs::internal::Portable_arithmetic>(damping, count, fits);
}

#if PCS_HAS_RUNTIME_DISPATCH
PCS_TARGET_AVX2 inline void
fit_rotations_avx2(double damping, std::size_t count, Rotation_fits& fits)
{
  fit_rotations<pcs::internal::Avx2_arithmetic>(damping, count, fits);
}

PCS_TARGET_AVX512 inline void
fit_rotations_avx512(double damping, std::size_t count, Rotation_fits& fits)
{
  fit_rotations<pcs::internal::Avx512_arithmetic>(damping, count, fits);
}
#endif

} // namespace internal

/*!
  Performs, for the first `count` fits, one step of Newton's method (`newton_turn()`) from the
  current rotation towards the maximiser of `trace(R^T covariance)`. The results are deviations from
  the field (`rodrigues_from_rotation()`).
*/
using Fit_rotations = void (*)(double damping, std::size_t count, Rotation_fits& fits);

/// Returns the kernel for this machine. All kernels give the same bits.
inline Fit_rotations choose_fit_rotations()
{
#if PCS_HAS_RUNTIME_DISPATCH
  if (pcs::internal::has_avx512())
    return &internal::fit_rotations_avx512;
  if (pcs::internal::has_avx2())
    return &internal::fit_rotations_avx2;
#endif
  return &internal::fit_rotations_default;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SOLVER_FIT_ROTATIONS_H
