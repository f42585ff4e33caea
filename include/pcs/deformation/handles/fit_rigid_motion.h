// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rigid motion that best fits targets of points.

#ifndef PCS_DEFORMATION_HANDLES_FIT_RIGID_MOTION_H
#define PCS_DEFORMATION_HANDLES_FIT_RIGID_MOTION_H

#include <pcs/core/Similarity.h>
#include <pcs/core/rotations.h>
#include <pcs/deformation/model/Affine_map.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

/// Singular values of a covariance below this fraction of the largest one count as zero. [-]
constexpr double smallest_determined_share = 1e-10;

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
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  const Eigen::Matrix3d v = svd.matrixV();
  if (!(svd.singularValues()[1] > smallest_determined_share * svd.singularValues()[0]))
    return Quaternion::FromTwoVectors(Vec3(v.col(0)), Vec3(u.col(0)));
  if ((u * v.transpose()).determinant() < 0)
    u.col(2) = -u.col(2);
  return Quaternion(Eigen::Matrix3d(u * v.transpose())).normalized();
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
