// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pose of two trees: up direction, and whether yaw is free.

#ifndef PCS_SHAPE_SPACE_MODEL_ALIGNMENT_OPTIONS_H
#define PCS_SHAPE_SPACE_MODEL_ALIGNMENT_OPTIONS_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/constants.h>
#include <pcs/shape_space/model/Rooted_tree.h>

#include <Eigen/Geometry>

#include <cmath>

namespace pcs {
namespace shape_space {

/// Alignment of the second of two trees with the first.
struct Alignment_options
{
  Orl_alignment alignment = Orl_alignment::as_given;
  Vec3 up = Vec3::UnitZ(); ///< the vertical, of unit length
};

/// Returns the angle of a rotation about `axis`, of unit length, in [-pi, pi]. [rad]
inline double angle_about(const Vec3& axis, const Eigen::Quaterniond& rotation)
{
  const double angle = 2 * std::atan2(rotation.vec().dot(axis), rotation.w());
  return std::remainder(angle, 2 * pcs::internal::pi);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_ALIGNMENT_OPTIONS_H
