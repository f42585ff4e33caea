// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rigid motion that best fits targets of points.

#ifndef PCS_DEFORMATION_HANDLES_FIT_RIGID_MOTION_H
#define PCS_DEFORMATION_HANDLES_FIT_RIGID_MOTION_H

#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Affine_map.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// Singular values of a covariance below this fraction of the largest one count as zero. [-]
constexpr double smallest_determined_share = 1e-10;

/// Returns the smallest rotation that turns the unit vector `from` to `to`; within 1e-6 rad of
/// opposite vectors, a rotation that may be larger by as much.
inline Quaternion smallest_rotation(const Vec3& from, const Vec3& to)
{
  const Vec3 half = from + to;
  if (half.squaredNorm() < 1e-12) { // to the opposite of `to`, and half a turn across it
    const Vec3 axis = to.unitOrthogonal();
    return Quaternion(0, axis.x(), axis.y(), axis.z()) * smallest_rotation(from, -to);
  }
  const Vec3 middle = half.normalized(), axis = from.cross(middle);
  return Quaternion(from.dot(middle), axis.x(), axis.y(), axis.z()).normalized();
}

/*!
  Returns the rotation `R` that maximises `trace(R^T covariance)`, for the covariance
  `sum (y - mean y)(x - mean x)^T` of deformed and original positions (W. Kabsch, "A solution for
  the best rotation to relate two sets of vectors", Acta Crystallographica A 32, 1976). If the
  covariance has rank 1, as for collinear points, it is the smallest rotation that maximises the
  trace; if the covariance is zero, it is the identity.
*/
inline Quaternion best_rotation(const Eigen::Matrix3d& covariance)
{
  if (!(covariance.cwiseAbs().maxCoeff() > 0) || !covariance.allFinite())
    return Quaternion::Identity();
  const Eigen::Matrix3d c = covariance / covariance.cwiseAbs().maxCoeff();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen; // right singular vectors
  eigen.computeDirect(c.transpose() * c);
  Vec3 v1 = eigen.eigenvectors().col(2);
  for (int step = 0; step < 2; ++step) // the direct method is accurate to half of the digits
    v1 = (c.transpose() * (c * v1)).normalized();
  const Vec3 v2 =
      (eigen.eigenvectors().col(1) - v1.dot(eigen.eigenvectors().col(1)) * v1).normalized();
  const Vec3 u1 = (c * v1).normalized();
  const Vec3 across = c * v2 - u1.dot(c * v2) * u1;
  if (!(across.norm() > smallest_determined_share * (c * v1).norm()))
    return smallest_rotation(v1, u1);
  const Vec3 u2 = across.normalized();
  Eigen::Matrix3d u, v;
  u << u1, u2, u1.cross(u2);
  v << v1, v2, v1.cross(v2);
  Quaternion q(Eigen::Matrix3d(u * v.transpose()));
  for (int step = 0; step < 3; ++step) {
    const Eigen::Matrix3d m = c * q.toRotationMatrix().transpose();
    q = (rotation_exp(newton_turn(m, 0)) * q).normalized();
  }
  return q;
}

/*!
  Returns the rigid motion with the least sum of squared distances to the targets. Its rotation is
  by at most 180 degrees. Where the points do not determine it, it is the smallest one: a handle
  with one place is translated, and one with collinear places does not turn about its line. O(n).
  \param rest, target the same number of positions, at least one
*/
inline Similarity fit_rigid_motion(const std::vector<Vec3>& rest, const std::vector<Vec3>& target)
{
  const auto count = static_cast<double>(rest.size());
  Vec3 x = Vec3::Zero(), y = Vec3::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    x += rest[i] / count;
    y += target[i] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double of_rest = 0, of_target = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    covariance += (target[i] - y) * (rest[i] - x).transpose();
    of_rest += (rest[i] - x).squaredNorm();
    of_target += (target[i] - y).squaredNorm();
  }
  // Rounding errors of coincident positions determine no rotation.
  constexpr double rounding = 1e-12;
  const auto is_spread = [&](double squares, const Vec3& mean) {
    return std::sqrt(squares / count) > rounding * std::max(1.0, mean.cwiseAbs().maxCoeff());
  };
  Quaternion q = Quaternion::Identity();
  if (is_spread(of_rest, x) && is_spread(of_target, y))
    q = best_rotation(covariance);
  const Similarity turn = Similarity::from_turn(rotation_log(q));
  return Similarity::from_translation(y - turn(x)) * turn;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_FIT_RIGID_MOTION_H
