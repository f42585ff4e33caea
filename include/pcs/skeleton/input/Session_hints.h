// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Hints of the caller: directions, root, scanners, labels and switches.

#ifndef PCS_SKELETON_INPUT_SESSION_HINTS_H
#define PCS_SKELETON_INPUT_SESSION_HINTS_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/skeleton/model/Given_skeleton.h>
#include <pcs/skeleton/model/Scan.h>

#include <optional>
#include <vector>

namespace pcs {
namespace skeleton {

struct Session_hints
{
  Vec3 up = Vec3::UnitZ();
  std::optional<Vec3> root; ///< in input coordinates, like the next two
  std::vector<Vec3> scanners;
  std::optional<Given_skeleton> given; ///< its positions remain fixed
  double beam_width = 0;               ///< of the scanners [rad]
  bool do_register_stations = false;   ///< the stations of `stations`, or detected ones
  std::vector<long long> stations;     ///< of the points; empty: unknown
  bool do_mark_ground = true;
  bool do_continue_trunk = true;                         ///< for the method `chains`
  Leaf_removal leaf_removal = Leaf_removal::where_found; ///< for the method `chains`
  double breast_height = 1.3;                            ///< [L]
  Skeleton_method method = Skeleton_method::chains;
  Slice_options slices;      ///< for the method `sections`, like the next
  std::vector<Vec3> normals; ///< of the points, in input coordinates; null or empty: unknown
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_INPUT_SESSION_HINTS_H
