// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What a skeletonization may be told, and all of its rules.

#ifndef PCS_SKELETON_SESSION_OPTIONS_H
#define PCS_SKELETON_SESSION_OPTIONS_H

#include <pcs/skeleton/bound_radii.h>
#include <pcs/skeleton/correct_beam.h>
#include <pcs/skeleton/correct_grid.h>
#include <pcs/skeleton/count_stems.h>
#include <pcs/skeleton/estimate_sections.h>
#include <pcs/skeleton/find_leaves.h>
#include <pcs/skeleton/find_root.h>
#include <pcs/skeleton/fit_axes.h>
#include <pcs/skeleton/follow_bounds.h>
#include <pcs/skeleton/fuse_axes.h>
#include <pcs/skeleton/join_axes.h>
#include <pcs/skeleton/mark_ground.h>
#include <pcs/skeleton/mark_walls.h>
#include <pcs/skeleton/measure_given.h>
#include <pcs/skeleton/mend_foot.h>
#include <pcs/skeleton/merge_rings.h>
#include <pcs/skeleton/prune_stubs.h>
#include <pcs/skeleton/section_skeleton.h>

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

/// All rules of the pipeline, and the hints of the caller.
struct Session_options
{
  Vec3 up = Vec3::UnitZ();
  std::optional<Vec3> root; ///< in the coordinates of the input, as the next two
  std::vector<Vec3> scanners;
  std::optional<Given_skeleton> given; ///< measured, instead of looking for branches
  double beam_width = 0;               ///< of the scanners [rad]
  bool do_mark_ground = true;
  Leaf_removal leaf_removal = Leaf_removal::where_found; ///< by the method `chains`
  double breast_height = 1.3;                            ///< [L]
  Skeleton_method method = Skeleton_method::chains;
  Slice_rules slices; ///< of the method `sections`, like the next
  Section_tree_rules section_tree;
  Axis_rules axes;
  Fuse_rules fusion;
  Ring_rules rings;
  Root_rules roots;
  Ground_rules ground;
  Wall_rules walls;
  Leaf_rules leaves;
  Joint_rules joints;
  Stub_rules stubs;
  Support_rules support;
  Follow_rules following;
  Foot_rules foot;
  Stem_rules stems;
  Section_rules sections;
  Given_rules given_rules;
  Beam_rules beam;
  Grid_rules grid;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_OPTIONS_H
