// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// All rules of a skeletonization, and what it was told.

#ifndef PCS_SKELETON_SESSION_OPTIONS_H
#define PCS_SKELETON_SESSION_OPTIONS_H

#include <pcs/skeleton/Alignment_rules.h>
#include <pcs/skeleton/Beam_grid_rules.h>
#include <pcs/skeleton/Session_hints.h>
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

#include <utility>

namespace pcs {
namespace skeleton {

/// All rules of the pipeline, and the hints of the caller.
struct Session_options : Session_hints
{
  Session_options() = default;
  explicit Session_options(Session_hints hints) : Session_hints(std::move(hints)) {}

  bool do_trace_paths = true; ///< else `find_paths()` ends with the points that may be trees

  Beam_grid_rules beam_grids;
  Alignment_rules alignment;       ///< of stations
  Section_tree_rules section_tree; ///< of the method `sections`
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
