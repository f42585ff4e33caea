// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Difference between the targets of a handle and its motion, around one place.

#ifndef PCS_DEFORMATION_MODEL_TARGET_OFFSET_H
#define PCS_DEFORMATION_MODEL_TARGET_OFFSET_H

#include <pcs/deformation/model/Affine_map.h>

#include <Eigen/Core>

namespace pcs {
namespace deformation {

/*!
  Motion of the surroundings of a place `x` of a handle, relative to the motion `T` of the handle: a
  point `p` moves to `T(p) + offset + (linear - I) A (p - x)` with the linear part `A` of `T`.
*/
struct Target_offset
{
  Vec3 offset = Vec3::Zero();                           ///< [L]
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity(); ///< [-]

  /// Whether the surroundings move by `T`.
  bool is_zero() const { return offset == Vec3::Zero() && linear == Eigen::Matrix3d::Identity(); }

  /// Returns the offset at `p` instead of `x`; `turned` is the linear part of `T` times `p - x`.
  Vec3 offset_at(const Vec3& turned) const { return offset + (linear * turned - turned); }

  /// Moves `share` of the way to `other`.
  void blend(double share, const Target_offset& other)
  {
    offset += share * (other.offset - offset);
    linear += share * (other.linear - linear);
  }
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_TARGET_OFFSET_H
