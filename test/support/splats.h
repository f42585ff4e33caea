// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Spherical harmonics from their definition, and drawn splats.

#ifndef PCS_TEST_SUPPORT_SPLATS_H
#define PCS_TEST_SUPPORT_SPLATS_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <complex>
#include <cstddef>
#include <random>
#include <vector>

namespace pcs_test {

/// Returns the value at `z` of the derivative of order `m` of the Legendre polynomial of degree
/// `l`, from the formula of Rodrigues: the derivative of order l + m of (z^2 - 1)^l / (2^l l!).
inline double legendre_derivative(int l, int m, double z)
{
  std::vector<double> power = {1}; // coefficients by exponent
  for (int i = 0; i < l; ++i) {
    std::vector<double> next(power.size() + 2, 0);
    for (std::size_t k = 0; k < power.size(); ++k) {
      next[k] -= power[k] / (2.0 * (i + 1));
      next[k + 2] += power[k] / (2.0 * (i + 1));
    }
    power = next;
  }
  for (int i = 0; i < l + m; ++i) {
    std::vector<double> next(power.size() > 1 ? power.size() - 1 : 1, 0);
    for (std::size_t k = 1; k < power.size(); ++k)
      next[k - 1] = double(k) * power[k];
    power = next;
  }
  double sum = 0;
  for (std::size_t k = power.size(); k-- > 0;)
    sum = sum * z + power[k];
  return sum;
}

/// Returns the function `Y_lm` of splat files in the unit direction `d`: (-1)^m times the real
/// spherical harmonic without the phase of Condon and Shortley.
inline double harmonic(int l, int m, const Eigen::Vector3d& d)
{
  const int order = std::abs(m);
  double factor = (2 * l + 1) / (4 * std::acos(-1.0));
  for (int i = l - order + 1; i <= l + order; ++i)
    factor /= i;
  const std::complex<double> turn = std::pow(std::complex<double>(d.x(), d.y()), order);
  const double around = m == 0 ? 1 : std::sqrt(2.0) * (m > 0 ? turn.real() : turn.imag());
  return (order % 2 ? -1 : 1) * std::sqrt(factor) * around * legendre_derivative(l, order, d.z());
}

/// Returns the sum of the bands 1 to `degree` in the direction `d`. The coefficients are those of
/// one channel.
template <class FT>
double color(int degree, const FT* coefficients, const Eigen::Vector3d& d)
{
  double sum = 0;
  for (int l = 1; l <= degree; ++l)
    for (int m = -l; m <= l; ++m)
      sum += double(*coefficients++) * harmonic(l, m, d);
  return sum;
}

/// Draws numbers, directions and rotations.
class Splat_drawer
{
public:
  explicit Splat_drawer(unsigned seed) : m_engine(seed) {}

  /// Returns a number between -1 and 1.
  double number() { return 2 * (double(m_engine()) / 4294967295.0) - 1; }

  Eigen::Vector3d direction()
  {
    Eigen::Vector3d v;
    do
      v = {number(), number(), number()};
    while (v.norm() > 1 || v.norm() < 0.1);
    return v.normalized();
  }

  Eigen::Quaterniond quaternion()
  {
    Eigen::Vector4d v;
    do
      v = {number(), number(), number(), number()};
    while (v.norm() > 1 || v.norm() < 0.1);
    return Eigen::Quaterniond(Eigen::Vector4d(v.normalized()));
  }

  Eigen::Matrix3d rotation() { return quaternion().toRotationMatrix(); }

  /// Returns a matrix with a determinant of at least 0.05.
  Eigen::Matrix3d gradient()
  {
    Eigen::Matrix3d f;
    do
      for (int i = 0; i < 9; ++i)
        f(i / 3, i % 3) = 1.5 * number();
    while (f.determinant() < 0.05);
    return f;
  }

private:
  std::mt19937 m_engine;
};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_SPLATS_H
