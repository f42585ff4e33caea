// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The rotation that lays one bundle of vectors on another, from a rotation that is near.

#ifndef PCS_SHAPE_SPACE_BEST_TURN_H
#define PCS_SHAPE_SPACE_BEST_TURN_H

#include <pcs/core/rotations.h>

#include <Eigen/Core>

#include <cmath>

namespace pcs {
namespace shape_space {

/*!
  The maximiser of `trace(R^T covariance)`, uphill from `q`; what the bundle does not determine stays as in `q`.

  Newton's method where the trace is concave: three or four steps do for what `improve_rotation()` needs dozens, as its
  steps converge linearly when the bundle is narrow. Elsewhere its step is taken.
*/
inline Quaternion best_turn(const Eigen::Matrix3d& covariance, Quaternion q)
{
  constexpr int most_steps = 50;
  const double size = covariance.norm(), epsilon = 1e-9 * size + 1e-300;
  for (int i = 0; i < most_steps; ++i) {
    // the trace at exp(u) R is trace(m) + torque u - u^T hessian u / 2 + ...
    const Eigen::Matrix3d m = covariance * q.toRotationMatrix().transpose();
    const Eigen::Vector3d torque(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
    const double trace = m.trace();
    Eigen::Matrix3d hessian = -0.5 * (m + m.transpose());
    hessian.diagonal().array() += trace + epsilon;
    const double minor = hessian(0, 0) * hessian(1, 1) - hessian(0, 1) * hessian(0, 1);
    const double determinant = hessian.determinant();
    Eigen::Vector3d u = torque / (std::abs(trace) + epsilon);
    if (hessian(0, 0) > 0 && minor > 0 && determinant > 0) {
      const Eigen::Matrix3d adjugate = (Eigen::Matrix3d() << hessian.col(1).cross(hessian.col(2)),
                                        hessian.col(2).cross(hessian.col(0)),
                                        hessian.col(0).cross(hessian.col(1)))
                                           .finished();
      const Eigen::Vector3d step = adjugate * torque / determinant; // symmetric
      if (step.squaredNorm() < 1)
        u = step;
    }
    q = rotation_exp(u) * q;
    q.normalize();
    if (u.squaredNorm() < 1e-20)
      break;
  }
  return q;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_BEST_TURN_H
