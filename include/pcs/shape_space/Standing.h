// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How two trees stand to each other.

#ifndef PCS_SHAPE_SPACE_STANDING_H
#define PCS_SHAPE_SPACE_STANDING_H

#include <pcs/shape_space/Rooted_tree.h>

#include <Eigen/Geometry>

#include <cmath>

namespace pcs {
namespace shape_space {

/// Whether the second of two trees may stand turned as a whole.
enum class Alignment {
  as_given, ///< both stand in the same axes
  turns     ///< about the vertical, by any angle: pots are put down anew
};

/// How the two trees stand to each other.
struct Standing
{
  Alignment alignment = Alignment::as_given;
  Vec3 up = Vec3::UnitZ(); ///< the vertical, of unit length
};

/// Of a turn about `axis`, of unit length: in [-pi, pi]. [rad]
inline double angle_about(const Vec3& axis, const Eigen::Quaterniond& turn)
{
  const double angle = 2 * std::atan2(turn.vec().dot(axis), turn.w());
  return std::remainder(angle, 2 * static_cast<double>(EIGEN_PI));
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STANDING_H
