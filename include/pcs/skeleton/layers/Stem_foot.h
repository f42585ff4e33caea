// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Position where a stem leaves the ground.

#ifndef PCS_SKELETON_LAYERS_STEM_FOOT_H
#define PCS_SKELETON_LAYERS_STEM_FOOT_H

#include <pcs/skeleton/model/Scan.h>

namespace pcs {
namespace skeleton {

/// Position where the stem of a tree leaves the ground.
struct Stem_foot
{
  Vec3 center = Vec3::Zero();
  double width = 0; ///< lower quartile of the root mean square widths of the stem [L]
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_STEM_FOOT_H
