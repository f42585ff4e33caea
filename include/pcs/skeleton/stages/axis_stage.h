// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Third stage of a skeletonization: axes or sections, and leaf-wood separation.

#ifndef PCS_SKELETON_STAGES_AXIS_STAGE_H
#define PCS_SKELETON_STAGES_AXIS_STAGE_H

#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/axes/reassign_points.h>
#include <pcs/skeleton/slices/section_skeleton.h>
#include <pcs/skeleton/stages/path_stage.h>
#include <pcs/skeleton/stages/stage_progress.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Classifies the points, in the first round of the leaf-wood separation.
template <class Tag>
std::vector<std::uint8_t> find_wood_by_points(Session_state<Tag>& s)
{
  const Session_options& o = s.options;
  const auto trunk = [&]() -> const Axis& {
    return s.axes.axes[root_axis(s.scan, s.axes, s.root, root_hint(s))].axis;
  };
  return wood_by_points<Tag>(s.scan,
                             s.axes,
                             s.is_used(),
                             s.paths,
                             s.root,
                             trunk,
                             o.leaf_removal == Leaf_removal::always,
                             o.breast_height,
                             o.leaves,
                             s.leaves);
}

/// Classifies the axes, in the later rounds.
template <class Tag>
std::vector<std::uint8_t> find_wood_by_axes(Session_state<Tag>& s)
{
  const Session_options& o = s.options;
  return wood_by_axes<Tag>(s.scan,
                           s.axes,
                           s.is_used(),
                           s.paths,
                           o.breast_height,
                           o.leaves,
                           s.leaves);
}

template <class Tag>
std::vector<std::uint8_t> find_wood(Session_state<Tag>& s)
{
  if (s.leaves.rounds > 0)
    return find_wood_by_axes(s);
  std::vector<std::uint8_t> is_wood = find_wood_by_points(s);
  s.report.is_in_rows = s.leaves.is_in_rows;
  if (s.leaves.has_leaves)
    s.leaves.is_stem = points_of_stem(s.layers, s.leaves.wood_score, s.options.leaves.stem);
  return is_wood;
}

/// Keeps the root and the wood of the stem, whatever is found out about single points and axes.
template <class Tag>
void keep_foot(const Session_state<Tag>& s, std::vector<std::uint8_t>& is_wood)
{
  for (Index i = 0; i < s.leaves.is_stem.size(); ++i)
    if (s.leaves.is_stem[i] && s.is_used()[i])
      is_wood[i] = 1;
  for (const Index i : s.root)
    is_wood[i] = 1;
}

/// Removes leaves, or points far from wood if there are no leaves, and computes the level sets of
/// the remaining points. Returns `false` if there is nothing to remove.
template <class Tag>
bool remove_leaves(Session_state<Tag>& s)
{
  if (s.axes.axes.empty() || (s.leaves.rounds > 0 && !s.leaves.has_leaves))
    return false;
  std::vector<std::uint8_t> is_wood = find_wood(s);
  if (std::find(is_wood.begin(), is_wood.end(), 1) == is_wood.end())
    return false; // no wood
  keep_foot(s, is_wood);
  if (is_wood == s.is_used())
    return false;
  s.labels.remove_leaves(is_wood);
  Compact_links links = used_links(s);
  Linked_parts linked;
  link_used(s, links, Known_root::points, linked);
  trace_layers(s, links, linked);
  ++s.leaves.rounds; // after a cancellation, the work continues with the wood
  return true;
}

/// Fits axes and removes leaves, in rounds, as long as there are leaves.
template <class Tag>
bool fit_wood(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const bool may_remove = s.options.leaf_removal != Leaf_removal::never;
  const int rounds = may_remove ? s.options.leaves.rounds : 0;
  do {
    const int k = s.leaves.rounds;
    const double width = end_of_fits - end_of_first_fit;
    const double from = k == 0 ? end_of_paths : end_of_first_fit + width * (k - 1) / rounds;
    const double part = k == 0 ? end_of_first_fit - end_of_paths : width / rounds;
    bool is_running = true;
    s.axes = skeleton::fit_axes<Tag>(s.scan, s.layers, s.options.axes, [&](double f) {
      return is_running = progress(from + part * f);
    });
    if (!is_running)
      return false;
  } while (s.leaves.rounds < rounds && remove_leaves(s));
  return true;
}

/// Restores removed points that lie on an axis as wood. If there are no leaves, restores all
/// removed points.
template <class Tag>
void restore_wood(Session_state<Tag>& s)
{
  if (s.leaves.rounds > 0) {
    const std::size_t count =
        reassign_points<Tag>(s.scan, s.options.axes.chains, s.labels.found_leaves(), s.axes);
    s.labels.restore_leaves(count, [&](Index i) { return s.axes.is_covered(i); });
  }
  if (!s.leaves.has_leaves)
    s.labels.undo_leaf_removal();
}

/// Returns the thick axes of thinned scans.
template <class Tag>
std::vector<Coarse_axis> find_coarse_axes(const Session_state<Tag>& s,
                                          pcs::internal::Progress& progress)
{
  const Session_options& o = s.options;
  return skeleton::find_coarse_axes<Tag>(
      s.scan,
      s.is_used(),
      s.root,
      s.axes,
      o.thick_ends.least_radius(s.scan.spacing, s.axes.noise),
      o.axes,
      o.layers,
      o.coarse_axes,
      [&](double f) { return progress(end_of_fits + (end_of_coarse_fits - end_of_fits) * f); });
}

/// Finds thick wood with few points, and continues thick axes through it. The axes do not change if
/// `progress` stops the work.
template <class Tag>
bool continue_thick_axes(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const Session_options& o = s.options;
  const std::vector<Coarse_axis> coarse = find_coarse_axes(s, progress);
  if (progress.is_cancelled())
    return false;
  Axis_set axes = s.axes;
  const Followed_ends ends = follow_thick_ends(
      s.scan,
      s.is_used(),
      o.axes.chains,
      o.thick_ends,
      s.root,
      coarse,
      o.coarse_axes,
      [&](double f) {
        return progress(end_of_coarse_fits + (end_of_axes - end_of_coarse_fits) * f);
      },
      axes);
  if (!ends.is_complete)
    return false;
  s.axes = std::move(axes);
  s.report.number_of_unexplained_thick_points = ends.number_of_unexplained_points;
  return true;
}

/// Fits the axes of all branches, removes leaves, fuses pieces of the same axis, and continues
/// thick axes.
template <class Tag>
bool fit_all_axes(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  if (s.stage < Stage::fits) {
    if (!fit_wood(s, progress))
      return false;
    restore_wood(s);
    fuse_axes<Tag>(s.scan.spacing, s.options.branching.fusion, s.axes);
    s.stage = Stage::fits;
  }
  if (!continue_thick_axes(s, progress))
    return false;
  const double unit = s.scan.frame.unit;
  s.report.noise = unit * s.axes.noise;
  s.report.density = s.axes.density / (unit * unit);
  return true;
}

/// Detects sections at centers of curvature, for the method `sections`.
template <class Tag>
bool find_sections(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const std::vector<Surface_frame> frames =
      principal_curvatures<Tag>(s.scan, normals_of_scan(s.scan, s.options.normals));
  if (!progress(0.7))
    return false;
  s.sections = detect_sections<Tag>(s.scan, s.is_used(), frames, s.options.slices, [&](double f) {
    return progress(0.7 + 0.2 * f);
  });
  return !progress.is_cancelled();
}

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_STAGES_AXIS_STAGE_H
