// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Polar decomposition, and the half axes of a deformed ellipsoid in the order of the old ones.

#ifndef PCS_SPLATS_PRINCIPAL_AXES_H
#define PCS_SPLATS_PRINCIPAL_AXES_H

#include <pcs/core/rotations.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pcs {
namespace splats {
namespace internal {

/*!
  Returns the rotation `Q` of the polar decomposition `a = Q P`, by Newton's iteration
  `X <- (s X + X^-T / s) / 2` [Higham, "Computing the polar decomposition - with applications",
  1986] with the factor `s = |det X|^(-1/3)`. Matrices whose determinant is not positive, or too
  small for the iteration, obtain the rotation of `improve_rotation()`.
*/
inline Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& a)
{
  constexpr int most_steps = 20;
  const double size = a.cwiseAbs().maxCoeff();
  Eigen::Matrix3d x = a / (size > 0 ? size : 1.0);
  if (!(x.determinant() > 1e-9))
    return improve_rotation(x, Quaternion::Identity(), 100).toRotationMatrix();
  for (int step = 0; step < most_steps; ++step) {
    Eigen::Matrix3d cofactor;
    cofactor.row(0) = x.row(1).cross(x.row(2));
    cofactor.row(1) = x.row(2).cross(x.row(0));
    cofactor.row(2) = x.row(0).cross(x.row(1));
    const double determinant = x.row(0).dot(cofactor.row(0));
    // The factor accelerates the first steps; near 1 it only costs a root.
    const double s = std::abs(determinant - 1) > 0.1 ? 1 / std::cbrt(determinant) : 1.0;
    const Eigen::Matrix3d next = (0.5 * s) * x + (0.5 / (s * determinant)) * cofactor;
    const double change = (next - x).cwiseAbs().maxCoeff();
    x = next;
    if (change < 1e-8) // the error of the next step would be the square of it
      break;
  }
  return x;
}

/// The half axes of an ellipsoid.
struct Principal_axes
{
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(); ///< the directions, as columns
  Eigen::Vector3d log_scale = Eigen::Vector3d::Zero();
  bool is_aligned = true; ///< whether `rotation` is the identity
};

/// Rotates the columns `p < q` until they are orthogonal up to 1e-9, far below the precision of the
/// files. Returns `false` if they are already.
inline bool make_orthogonal(int p, int q, Eigen::Matrix3d& a)
{
  constexpr double tolerance = 1e-9;
  const double pp = a.col(p).squaredNorm(), qq = a.col(q).squaredNorm();
  const double pq = a.col(p).dot(a.col(q));
  if (pq * pq <= tolerance * tolerance * (pp * qq))
    return false;
  // tangent of the smaller of the two angles
  const double difference = qq - pp;
  const double t = (difference < 0 ? -2 : 2) * pq /
                   (std::abs(difference) + std::sqrt(difference * difference + 4 * (pq * pq)));
  const double c = 1 / std::sqrt(1 + t * t), s = c * t;
  const Eigen::Vector3d old = a.col(p);
  a.col(p) = c * old - s * a.col(q);
  a.col(q) = s * old + c * a.col(q);
  return true;
}

/// Returns a vector of length 1 that is orthogonal to the unit vector `u`, near `v` if possible.
inline Eigen::Vector3d orthogonal_direction(const Eigen::Vector3d& u, const Eigen::Vector3d& v)
{
  Eigen::Vector3d w = v - u.dot(v) * u;
  if (!(w.squaredNorm() > 0.25 * v.squaredNorm())) // rounding determines the direction of `v`
    w = u.unitOrthogonal();
  return w.normalized();
}

/// Returns the directions of the columns of `a`, which are orthogonal. Those that rounding
/// determines, because the columns are too short, are completed to a rotation.
inline Eigen::Matrix3d directions_of_columns(const Eigen::Matrix3d& a)
{
  std::array<int, 3> order = {0, 1, 2};
  const Eigen::Vector3d length = a.colwise().norm();
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return length[i] > length[j] || (length[i] == length[j] && i < j);
  });
  Eigen::Matrix3d u;
  if (!(length[order[0]] > 0))
    return Eigen::Matrix3d::Identity();
  u.col(order[0]) = a.col(order[0]) / length[order[0]];
  const double second = length[order[1]];
  u.col(order[1]) = orthogonal_direction(u.col(order[0]),
                                         second > 0 ? Eigen::Vector3d(a.col(order[1]) / second)
                                                    : Eigen::Vector3d::Zero());
  const bool is_even = (order[1] - order[0] + 3) % 3 == 1;
  u.col(order[2]) = (is_even ? 1.0 : -1.0) * u.col(order[0]).cross(u.col(order[1]));
  return u;
}

/// Reverses columns of the rotation or reflection `u` so that it is a rotation near the identity.
inline void align(Eigen::Matrix3d& u)
{
  for (int i = 0; i < 3; ++i)
    if (u(i, i) < 0)
      u.col(i) = -u.col(i);
  if (u.determinant() < 0) {
    Eigen::Index least = 0;
    u.diagonal().cwiseAbs().minCoeff(&least);
    u.col(least) = -u.col(least);
  }
}

/*!
  Returns the half axes of the ellipsoid with the covariance `m S^2 m^T`, where `S` is diagonal with
  the logarithms `log_scale`. Axis `i` is the one that comes from the column `i` of `m S` by
  rotations of at most 45 degrees, so that the axes of flat and thin ellipsoids keep their roles.
  One-sided Jacobi rotations of the columns of `m S` [Hestenes,
  "Inversion of matrices by biorthogonalization and related results", 1958] keep the relative
  precision of short axes.
*/
inline Principal_axes principal_axes(const Eigen::Matrix3d& m, const Eigen::Vector3d& log_scale)
{
  constexpr double least_log = -69;       // 1e-30: shorter axes are negligible beside the longest
  constexpr double least_stretch = 1e-15; // the precision of the gradient
  constexpr int most_sweeps = 30;
  const double longest = log_scale.maxCoeff();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  if (std::isfinite(longest))
    scale = (log_scale.array() - longest).max(least_log).exp();
  Eigen::Matrix3d a = m * scale.asDiagonal();
  Principal_axes result;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool is_changed = make_orthogonal(0, 1, a);
    is_changed = make_orthogonal(0, 2, a) || is_changed;
    is_changed = make_orthogonal(1, 2, a) || is_changed;
    if (!is_changed)
      break;
  }
  for (int i = 0; i < 3; ++i) {
    const double length = a.col(i).norm();
    result.is_aligned = result.is_aligned && a(i, i) >= (1 - 1e-12) * length;
    result.log_scale[i] = log_scale[i] + std::log(std::max(length / scale[i], least_stretch));
  }
  if (!result.is_aligned) {
    result.rotation = directions_of_columns(a);
    align(result.rotation);
  }
  return result;
}

} // namespace internal
} // namespace splats
} // namespace pcs

#endif // PCS_SPLATS_PRINCIPAL_AXES_H
