// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// All options of a skeletonization, by stage.

#ifndef PCS_SKELETON_SESSION_OPTIONS_H
#define PCS_SKELETON_SESSION_OPTIONS_H

#include <pcs/skeleton/axes/fit_axes.h>
#include <pcs/skeleton/branching/build_branch_tree.h>
#include <pcs/skeleton/clutter/remove_clutter.h>
#include <pcs/skeleton/continuation/continue_hidden_trunk.h>
#include <pcs/skeleton/continuation/find_coarse_axes.h>
#include <pcs/skeleton/continuation/follow_thick_ends.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/layers/trace_layers.h>
#include <pcs/skeleton/leaves/find_leaf_blades.h>
#include <pcs/skeleton/leaves/separate_leaves.h>
#include <pcs/skeleton/radii/refine_radii.h>
#include <pcs/skeleton/registration/register_stations.h>
#include <pcs/skeleton/result/describe_tree.h>
#include <pcs/skeleton/scan/thin_dense_points.h>

#include <utility>

namespace pcs {
namespace skeleton {

/// The hints of the caller, and the options of all stages in the order of the flow.
struct Session_options : Session_hints
{
  Session_options() = default;
  explicit Session_options(Session_hints hints) : Session_hints(std::move(hints)) {}

  bool do_trace_paths = true; ///< if `false`, `find_paths()` ends with the points that may be trees

  bool do_thin = true; ///< whether the points of dense scans are merged

  Registration_options registration;
  Thinning_options thinning;
  Clutter_options clutter;
  Layer_options layers;
  Axis_options axes;
  Coarse_axis_options coarse_axes;
  Thick_end_options thick_ends;
  Hidden_trunk_options hidden_trunk;
  Leaf_options leaves;
  Blade_options blades;
  Branching_options branching;
  Radius_options radii;
  Stem_options stems;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_OPTIONS_H
