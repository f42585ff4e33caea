// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Last stage of a skeletonization: tree of branches, radii, sizes.

#ifndef PCS_SKELETON_STAGES_BRANCH_STAGE_H
#define PCS_SKELETON_STAGES_BRANCH_STAGE_H

#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/branching/level_set_skeleton.h>
#include <pcs/skeleton/slices/section_skeleton.h>
#include <pcs/skeleton/stages/path_stage.h>
#include <pcs/skeleton/stages/stage_progress.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Returns whether the point belongs to the tree, as wood or as a leaf.
template <class Tag>
bool is_tree_point(const Session_state<Tag>& s, Index i)
{
  return s.is_used()[i] != 0 || s.labels.is_leaf(i);
}

/// Continues a trunk that is hidden, and reports the sizes of the inferred part.
template <class Tag>
void continue_trunk(Session_state<Tag>& s)
{
  double top = s.labels.top_of_leaves(s.options.up);
  for (const Branch_node& node : s.joined.tree.nodes)
    top = std::max(top, s.options.up.dot(node.point));
  const Hidden_trunk_part part = continue_hidden_trunk(
      s.scan,
      [&s](Index i) { return is_tree_point(s, i); },
      top,
      s.options.breast_height,
      s.options.hidden_trunk,
      s.joined.tree);
  const double unit = s.scan.frame.unit;
  s.report.hidden_trunk_length = unit * part.length;
  s.report.hidden_trunk_volume = unit * unit * unit * part.volume;
}

/// Removes the axes that stand on the ground beside the tree, and all that are joined to them.
template <class Tag>
void remove_objects(Session_state<Tag>& s)
{
  const std::vector<std::uint8_t> is_object = axes_of_objects(s.joined);
  const auto count = static_cast<std::size_t>(std::count(is_object.begin(), is_object.end(), 1));
  s.joined.tree.number_of_unreached_axes -= count;
  s.report.number_of_standing_branches = count;
  if (count > 0)
    s.labels.remove_objects(
        [&](Index i) { return s.axes.is_covered(i) && is_object[s.axes.axis_of_point[i]] != 0; });
}

template <class Tag>
bool build_tree(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const Session_options& o = s.options;
  if (s.axes.axes.empty())
    return true;
  const auto joining = [&](double f) {
    return progress(end_of_axes + (end_of_joints - end_of_axes) * f);
  };
  if (!build_branch_tree<Tag>(s.scan,
                              s.root,
                              root_hint(s),
                              o.given ? Ground() : s.clutter.ground(), // it has all branches
                              o.branching,
                              joining,
                              s.axes,
                              s.joined))
    return false;
  remove_objects(s);
  if (s.leaves.has_leaves && s.leaves.rounds > 0) // remaining leaves make twigs thick
    s.options.radii.support.pipes.slack = o.leaves.pipe_slack;
  refine_radii<Tag>(s.scan, s.is_used(), s.axes, o.radii, s.joined.tree);
  if (!o.given) { // a given skeleton is one tree, and complete
    s.report.number_of_other_stems =
        count_other_stems(s.axes, s.joined.joints, s.joined.root, s.joined.tree, o.stems);
    if (o.do_continue_trunk && s.leaves.has_leaves && s.leaves.rounds > 0) // leaves hide wood
      continue_trunk(s);
  }
  return true;
}

/// Replaces the tree by the given skeleton with measured radii.
template <class Tag>
void measure_given_skeleton(Session_state<Tag>& s)
{
  const Session_options& o = s.options;
  s.joined.tree = measure_given(s.scan,
                                s.labels.is_empty() ? s.may_be_tree : s.is_used(),
                                *o.given,
                                s.joined.tree,
                                o.radii.given);
}

template <class Tag>
void correct_widening(Session_state<Tag>& s)
{
  const Session_options& o = s.options;
  s.report.voxel_size =
      s.scan.frame.unit *
      skeleton::correct_widening(s.scan, o.scanners, o.beam_width, o.radii, s.joined.tree);
}

template <class Tag>
void describe_tree(Session_state<Tag>& s)
{
  const Session_options& o = s.options;
  const auto is_tree = [&s](Index i) { return is_tree_point(s, i); };
  s.successors = successors(s.joined.tree);
  skeleton::describe_tree(s.scan,
                          s.is_used(),
                          is_tree,
                          s.axes,
                          s.joined.tree,
                          s.successors,
                          o.up,
                          o.breast_height,
                          s.labels.top_of_leaves(o.up),
                          s.report);
}

/// Corrects the radii, fits ellipses to the sections, and describes the tree.
template <class Tag>
void measure_sections(Session_state<Tag>& s)
{
  const pcs::internal::Stage_timer timer(s.report.seconds.sections);
  correct_widening(s);
  fit_section_ellipses<Tag>(s.scan, s.axes.noise, s.options.radii.sections, s.joined.tree);
  fit_branch_ovals<Tag>(s.scan, s.axes.noise, s.options.radii.ovals, s.joined.tree);
  describe_tree(s);
}

/// Builds the tree of the methods `sections` and `level_sets`.
template <class Tag>
bool join_centers(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const pcs::internal::Stage_timer timer(s.report.seconds.joints);
  s.joined.tree =
      s.options.method == Skeleton_method::sections
          ? section_skeleton<Tag>(s.scan, s.is_used(), s.sections, s.root, s.options.slices)
          : level_set_skeleton(s.scan, s.layers, s.root);
  correct_widening(s);
  describe_tree(s);
  return finish(s, Stage::joints, end_of_radii, progress);
}

/// Builds the tree of the method `chains`, or measures the radii of the given skeleton.
template <class Tag>
bool join_branches(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const pcs::internal::Stage_timer timer(s.report.seconds.joints);
  if (!build_tree(s, progress))
    return false;
  if (s.options.given)
    measure_given_skeleton(s);
  return progress(end_of_radii);
}

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_STAGES_BRANCH_STAGE_H
