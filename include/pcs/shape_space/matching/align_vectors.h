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
  The maximiser of `trace(R^T covariance)`, uphill from `q`; what the bundle does not determine
  stays as in `q`.

  Newton's method where the trace is concave: three or four steps do for what `improve_rotation()`
  needs dozens, as its steps converge linearly when the bundle is narrow. Elsewhere its step is
  taken.
*/
inline Quaternion align_vectors(Eigen::Matrix3d covariance, Quaternion q)
{
  // cubes of numbers in any unit have a place; a power of 2 changes no bit
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
