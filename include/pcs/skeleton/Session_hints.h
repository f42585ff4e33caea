// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What the caller may tell a skeletonization.

#ifndef PCS_SKELETON_SESSION_HINTS_H
#define PCS_SKELETON_SESSION_HINTS_H

#include <pcs/skeleton/Given_skeleton.h>
#include <pcs/skeleton/Scan.h>
#include <pcs/skeleton/Slice_rules.h>

#include <optional>
#include <vector>

namespace pcs {
namespace skeleton {

/// How branches are found.
enum class Skeleton_method {
  chains, ///< whole axes are fitted to the layers of the paths from the root
  sections ///< the dissertation: sections at centers of curvature, spanning trees where there are none
};

/// Whether points of leaves are looked for and left out.
enum class Leaf_removal {
  where_found, ///< where there is evidence of them
  always,
  never
};

struct Session_hints
{
  Vec3 up = Vec3::UnitZ();
  std::optional<Vec3> root; ///< in the coordinates of the input, as the next two
  std::vector<Vec3> scanners;
  std::optional<Given_skeleton> given; ///< measured; its positions stay
  double beam_width = 0;               ///< of the scanners [rad]
  bool do_register_stations = false;   ///< those of `stations`, or those that are found
  std::vector<long long> stations;     ///< of the points; empty: not known
  bool do_mark_ground = true;
  Leaf_removal leaf_removal = Leaf_removal::where_found; ///< by the method `chains`
  double breast_height = 1.3;                            ///< [L]
  Skeleton_method method = Skeleton_method::chains;
  Slice_rules slices; ///< of the method `sections`
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_HINTS_H
