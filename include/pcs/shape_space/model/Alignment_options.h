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

/// How the two trees stand to each other.
struct Alignment_options
{
  Orl_alignment alignment = Orl_alignment::as_given;
  Vec3 up = Vec3::UnitZ(); ///< the vertical, of unit length
};

/// Of a turn about `axis`, of unit length: in [-pi, pi]. [rad]
inline double angle_about(const Vec3& axis, const Eigen::Quaterniond& turn)
{
  const double angle = 2 * std::atan2(turn.vec().dot(axis), turn.w());
  return std::remainder(angle, 2 * pcs::internal::pi);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_ALIGNMENT_OPTIONS_H
