// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rigid motion of the points of a scanner station.

#ifndef PCS_SKELETON_REGISTRATION_RIGID_MOTION_H
#define PCS_SKELETON_REGISTRATION_RIGID_MOTION_H

#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Geometry>

namespace pcs {
namespace skeleton {

/// A rigid motion: a rotation about the origin, then a translation.
struct Rigid_motion
{
  Vec3 shift = Vec3::Zero(); ///< translation [L]
  Vec3 turn = Vec3::Zero();  ///< rotation vector [rad]

  Eigen::Matrix3d rotation() const
  {
    const double angle = turn.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()
                     : Eigen::Matrix3d::Identity().eval();
  }
  Vec3 operator()(const Vec3& p) const { return rotation() * p + shift; }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_RIGID_MOTION_H
