// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The ground below a tree, as it was found and removed.

#ifndef PCS_SKELETON_CLUTTER_GROUND_H
#define PCS_SKELETON_CLUTTER_GROUND_H

#include <pcs/skeleton/clutter/Terrain.h>
#include <pcs/skeleton/layers/Stem_foot.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <optional>

namespace pcs {
namespace skeleton {

/// The ground of a scan. Without ground points, it is assumed to be level at the foot of the tree.
struct Ground
{
  std::size_t number_of_points = 0, number_of_object_points = 0;
  std::optional<Stem_foot> foot;  ///< of the tree that stands on it
  std::optional<Terrain> terrain; ///< its surface, if there are ground points and a foot
  double level = 0;               ///< otherwise, its height [L]
  double thickness = 0;           ///< of the ground above this surface or level [L]
  Vec3 up = Vec3::UnitZ();

  /// Returns the height of `p` above the ground [L].
  double height(const Vec3& p) const
  {
    return (terrain ? terrain->height(p) : up.dot(p) - level) - thickness;
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_GROUND_H
