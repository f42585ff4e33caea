// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// All rules of a skeletonization, and what it was told.

#ifndef PCS_SKELETON_SESSION_OPTIONS_H
#define PCS_SKELETON_SESSION_OPTIONS_H

#include <pcs/skeleton/axes/fit_axes.h>
#include <pcs/skeleton/branching/fuse_axes.h>
#include <pcs/skeleton/branching/join_axes.h>
#include <pcs/skeleton/branching/prune_stubs.h>
#include <pcs/skeleton/clutter/mark_ground.h>
#include <pcs/skeleton/clutter/mark_walls.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/layers/find_root.h>
#include <pcs/skeleton/layers/merge_ring_arcs.h>
#include <pcs/skeleton/leaves/classify_leaves.h>
#include <pcs/skeleton/radii/bound_radii.h>
#include <pcs/skeleton/radii/correct_beam_divergence.h>
#include <pcs/skeleton/radii/correct_voxel_size.h>
#include <pcs/skeleton/radii/fit_section_ellipses.h>
#include <pcs/skeleton/radii/measure_given.h>
#include <pcs/skeleton/radii/rebuild_trunk_base.h>
#include <pcs/skeleton/radii/recenter_bounded_nodes.h>
#include <pcs/skeleton/registration/Scan_grid_options.h>
#include <pcs/skeleton/registration/Station_alignment_options.h>
#include <pcs/skeleton/result/count_other_stems.h>
#include <pcs/skeleton/slices/section_skeleton.h>

#include <utility>

namespace pcs {
namespace skeleton {

/// All rules of the pipeline, and the hints of the caller.
struct Session_options : Session_hints
{
  Session_options() = default;
  explicit Session_options(Session_hints hints) : Session_hints(std::move(hints)) {}

  bool do_trace_paths = true; ///< else `find_paths()` ends with the points that may be trees

  Scan_grid_options beam_grids;
  Station_alignment_options alignment; ///< of stations
  Section_tree_options section_tree;   ///< of the method `sections`
  Axis_options axes;
  Fusion_options fusion;
  Ring_arc_options rings;
  Root_options roots;
  Ground_options ground;
  Wall_options walls;
  Leaf_options leaves;
  Joint_options joints;
  Stub_options stubs;
  Support_options support;
  Recentering_options following;
  Trunk_base_options foot;
  Stem_options stems;
  Section_ellipse_options sections;
  Given_skeleton_options given_rules;
  Beam_divergence_options beam;
  Voxel_size_options grid;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_OPTIONS_H
