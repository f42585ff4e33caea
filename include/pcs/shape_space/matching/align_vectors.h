// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rotation that aligns two sets of vectors (Wahba's problem), from an initial guess.

#ifndef PCS_SHAPE_SPACE_MATCHING_ALIGN_VECTORS_H
#define PCS_SHAPE_SPACE_MATCHING_ALIGN_VECTORS_H

#include <pcs/core/rotations.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace pcs {
namespace shape_space {

/*!
  Maximises `trace(R^T covariance)` by ascent from `q`; degrees of freedom that the vectors do not
  determine stay as in `q`.

  Where the trace is concave, three or four Newton steps replace dozens of calls of
  `improve_rotation()`, which converges linearly when the vectors are nearly parallel. Elsewhere, a
  step of `improve_rotation()` is taken.
*/
inline Quaternion align_vectors(Eigen::Matrix3d covariance, Quaternion q)
{
  // scaled, so that third powers stay in range in any unit; scaling by a power of 2 is exact
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (largest > 0 && std::isfinite(largest))
    covariance *= std::ldexp(1.0, std::min(1000, -std::ilogb(largest)));
  constexpr int most_steps = 50;
  for (int i = 0; i < most_steps; ++i) {
    const Eigen::Vector3d u = newton_turn(covariance * q.toRotationMatrix().transpose(), 0);
    q = rotation_exp(u) * q;
    q.normalize();
    if (u.squaredNorm() < 1e-20)
      break;
  }
  return q;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_ALIGN_VECTORS_H
