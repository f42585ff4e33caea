// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Local coordinates of a point cloud.

#ifndef PCS_DEFORMATION_MODEL_LOCAL_FRAME_H
#define PCS_DEFORMATION_MODEL_LOCAL_FRAME_H

#include <pcs/deformation/model/Affine_map.h>

namespace pcs {
namespace deformation {

/// Converts between the caller's coordinates and local ones. The origin is the median of the
/// points; the unit is a power of two, so that scaling is exact.
struct Local_frame
{
  Vec3 origin = Vec3::Zero(); ///< in the caller's coordinates [L]
  double unit = 1;            ///< length of the local unit [L]

  Vec3 to_local(const Vec3& p) const { return (p - origin) / unit; }
  Vec3 to_world(const Vec3& p) const { return p * unit + origin; }
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_LOCAL_FRAME_H
