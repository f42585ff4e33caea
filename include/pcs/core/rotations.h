// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotation vectors, unit quaternions and the optimal rotation between two sets of vectors.

#ifndef PCS_CORE_ROTATIONS_H
#define PCS_CORE_ROTATIONS_H

#include <pcs/internal/constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pcs {

using Quaternion = Eigen::Quaterniond;

/// Unit quaternion of the rotation by `|u|` radians about `u`. Angles beyond 2 pi keep their sign
/// on the double cover: `exp` of 360 degrees is -1.
inline Quaternion rotation_exp(const Eigen::Vector3d& u)
{
  const double angle = u.norm();
  // sin(t/2)/t = 1/2 - t^2/48 + ...; below 1e-4 the next term is less than rounding
  const double f = angle > 1e-4 ? std::sin(0.5 * angle) / angle : 0.5 - angle * angle / 48;
  return Quaternion(std::cos(0.5 * angle), f * u.x(), f * u.y(), f * u.z());
}

/// Rotation vector of the unit quaternion `q` on the double cover: length in [0, 2 pi]. [rad]
inline Eigen::Vector3d lifted_rotation_log(const Quaternion& q)
{
  const double s = q.vec().norm();
  if (!(s > 0)) // a full turn about any axis, or none
    return q.w() >= 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(2 * pcs::internal::pi, 0, 0);
  const double f = s > 1e-4 || q.w() < 0 ? 2 * std::atan2(s, q.w()) / s : 2 + s * s / 3;
  return f * q.vec();
}

/// Rotation vector of the rotation `q` with the smaller of its two angles: length in [0, pi]. [rad]
inline Eigen::Vector3d rotation_log(const Quaternion& q)
{
  return lifted_rotation_log(q.w() >= 0 ? q : Quaternion(-q.w(), -q.x(), -q.y(), -q.z()));
}

/// Unit quaternion of the smallest rotation that turns `from` to `to`, which have any nonzero
/// lengths. Of opposite directions, it is a half turn about any axis that is orthogonal to them.
/// This is `Eigen::Quaterniond::FromTwoVectors()`, which takes long to compile for its singular
/// value decomposition of opposite directions.
inline Quaternion rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to)
{
  const Eigen::Vector3d a = from.normalized(), b = to.normalized(), normal = a.cross(b);
  const double cosine = b.dot(a);
  Quaternion q;
  if (cosine < -1 + 1e-12) {
    const double w2 = 0.5 * (1 + std::max(cosine, -1.0)), length = normal.norm();
    const Eigen::Vector3d axis =
        length > 1e-8 ? Eigen::Vector3d(normal / length) : a.unitOrthogonal();
    q.w() = std::sqrt(w2);
    q.vec() = std::sqrt(1 - w2) * axis;
  } else {
    const double s = std::sqrt((1 + cosine) * 2), inverse = 1 / s;
    q.w() = s * 0.5;
    q.vec() = normal * inverse;
  }
  return q;
}

/*!
  Returns four times the modified Rodrigues parameters of the rotation \p q, which may have any
  nonzero length: `4 tan(angle / 4)` times its axis, with the smaller of its two angles. This is
  the stereographic projection of the unit quaternion (M. D. Shuster, "A survey of attitude
  representations", J. Astronautical Sciences 41, 1993). It differs from the rotation vector by
  about `angle^3 / 48`, has a length of at most 4 instead of pi, and requires a root and a division
  instead of an arc tangent.
*/
inline Eigen::Vector3d rodrigues_from_rotation(const Quaternion& q)
{
  // Scalars are faster, see `newton_turn()`.
  const double w = q.w(), x = q.x(), y = q.y(), z = q.z();
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  const double f = 4 / (w >= 0 ? w + length : w - length);
  return {f * x, f * y, f * z};
}

/// Unit quaternion with four times the modified Rodrigues parameters \p u; every \p u is valid.
inline Quaternion rotation_from_rodrigues(const Eigen::Vector3d& u)
{
  const double s = u.squaredNorm() / 16, inverse = 1 / (1 + s), f = 0.5 * inverse;
  return Quaternion((1 - s) * inverse, f * u.x(), f * u.y(), f * u.z());
}

/*!
  Improves the rotation `q` towards the maximiser of `trace(R^T covariance)`, where `covariance` is
  the sum of `w * deformed * rest^T` (M. Mueller et al., "A robust method to extract the rotational
  part of deformations", 2016). Components that the covariance does not determine (for collinear,
  coincident or no points) remain as in `q`, so the result is defined for every input.
*/
inline Quaternion
improve_rotation(const Eigen::Matrix3d& covariance, Quaternion q, int number_of_iterations)
{
  // below 1e-9 of the norm of the covariance, rounding determines the axis
  const double epsilon = 1e-9 * covariance.norm() + 1e-300;
  for (int i = 0; i < number_of_iterations; ++i) {
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const Eigen::Vector3d torque = r.col(0).cross(covariance.col(0)) +
                                   r.col(1).cross(covariance.col(1)) +
                                   r.col(2).cross(covariance.col(2));
    const double stiffness = std::abs(r.cwiseProduct(covariance).sum());
    const Eigen::Vector3d omega = torque / (stiffness + epsilon);
    q = rotation_exp(omega) * q;
    q.normalize();
    if (omega.squaredNorm() < 1e-20)
      break;
  }
  return q;
}

/*!
  Returns one step of Newton's method towards the maximiser of `trace(R^T covariance)`, as a
  rotation vector. \p m is `covariance R^T` with the current `R`; `damping`, relative to the trace,
  is added to the Hessian. The trace at `exp(u) R` is `trace(m) + torque u - u^T hessian u / 2 +
  ...`. If this model is not concave or its step is 1 rad or more, the step of `improve_rotation()`
  is returned.
*/
inline Eigen::Vector3d newton_turn(const Eigen::Matrix3d& m, double damping)
{
  // Scalars avoid stalls from reading a vector register whose halves were stored separately.
  const double x = m(2, 1) - m(1, 2), y = m(0, 2) - m(2, 0), z = m(1, 0) - m(0, 1);
  const double trace = m(0, 0) + m(1, 1) + m(2, 2);
  const double epsilon = std::max(damping * std::abs(trace), 1e-9 * m.lpNorm<1>()) + 1e-300;
  const double xx = m(1, 1) + m(2, 2) + epsilon, yy = m(0, 0) + m(2, 2) + epsilon,
               zz = m(0, 0) + m(1, 1) + epsilon, xy = -0.5 * (m(0, 1) + m(1, 0)),
               xz = -0.5 * (m(0, 2) + m(2, 0)), yz = -0.5 * (m(1, 2) + m(2, 1));
  // the adjugate of this Hessian
  const double axx = yy * zz - yz * yz, axy = xz * yz - xy * zz, axz = xy * yz - xz * yy,
               ayy = xx * zz - xz * xz, ayz = xy * xz - xx * yz, azz = xx * yy - xy * xy;
  const double determinant = xx * axx + xy * axy + xz * axz;
  if (xx > 0 && azz > 0 && determinant > 0) {
    const double inverse = 1 / determinant, u = inverse * (axx * x + axy * y + axz * z),
                 v = inverse * (axy * x + ayy * y + ayz * z),
                 w = inverse * (axz * x + ayz * y + azz * z);
    if (u * u + v * v + w * w < 1)
      return {u, v, w};
  }
  const double inverse = 1 / (std::abs(trace) + epsilon);
  return {inverse * x, inverse * y, inverse * z};
}

} // namespace pcs

#endif // PCS_CORE_ROTATIONS_H
