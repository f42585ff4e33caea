// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The steps of each stage of a skeletonization, on its state.

#ifndef PCS_SKELETON_SESSION_STAGES_H
#define PCS_SKELETON_SESSION_STAGES_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/axes/reassign_points.h>
#include <pcs/skeleton/branching/level_set_skeleton.h>
#include <pcs/skeleton/scan/Point_labels.h>
#include <pcs/skeleton/scan/measure_coordinate_step.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <pcs/skeleton/scan/thin_dense_points.h>
#include <pcs/skeleton/slices/section_skeleton.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Fractions of the work after which the stages end.
constexpr double end_of_neighbors = 0.35, end_of_clutter = 0.42, end_of_paths = 0.6,
                 end_of_first_fit = 0.75, end_of_axes = 0.9, end_of_joints = 0.95,
                 end_of_radii = 0.97;

template <class Tag>
bool finish(Session_state<Tag>& s, Stage stage, double end, pcs::internal::Progress& progress)
{
  s.stage = stage;
  return progress(end);
}

// ---- neighbours

/// Moves the points of the input to the scan.
template <class Tag>
void take_points(Session_state<Tag>& s)
{
  const Coordinate_step rounding = measure_coordinate_step(s.input);
  s.report.coordinate_step = rounding.step;
  s.report.is_single_precision = rounding.is_single_precision;
  skeleton::take_points<Tag>(std::move(s.input), s.options.up, s.scan);
}

/// Returns the options of the draft of the tree to which stations are registered. The draft uses a
/// subset of the points.
inline Session_options draft_options(Session_options options, const Scan_frame& frame)
{
  options.do_register_stations = false;
  options.do_thin = false; // merged points would not belong to one station
  options.stations.clear();
  options.normals.clear();
  options.method = Skeleton_method::chains;
  options.axes.passes = 1; // sufficient for thick wood, even in leaves
  options.leaf_removal = Leaf_removal::never;
  options.given.reset();
  options.up = Vec3::UnitZ();
  options.scanners.clear();
  options.breast_height /= frame.unit;
  if (options.root)
    options.root = frame.to_local(*options.root);
  return options;
}

/// Largest plausible shift of a station: 2 cm for scans in metres [-]. Registration errors are
/// millimetres, whereas flight lines of a drone differ by decimetres.
constexpr double max_shift_by_breast_height = 0.02 / 1.3;

/// Fits the axes of some points for the registration. Returns null if `progress` stopped it.
template <class Tag>
std::unique_ptr<Session<Tag>> fit_draft(const Session_state<Tag>& s,
                                        std::vector<Vec3> points,
                                        std::vector<std::uint8_t> is_wood,
                                        pcs::internal::Progress& progress)
{
  auto session = std::make_unique<Session<Tag>>(std::move(points),
                                                std::move(is_wood),
                                                draft_options(s.options, s.scan.frame));
  if (!session->fit_axes(progress))
    session.reset();
  return session;
}

template <class Tag>
bool register_stations(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  if (!s.options.do_register_stations)
    return true;
  const auto draft = [&s](auto points, auto is_wood, pcs::internal::Progress& draft_progress) {
    return fit_draft(s, std::move(points), std::move(is_wood), draft_progress);
  };
  return skeleton::register_stations<Tag>(s.is_wood,
                                          s.options.stations,
                                          s.options.registration,
                                          max_shift_by_breast_height * s.options.breast_height,
                                          draft,
                                          s.scan,
                                          s.report,
                                          progress);
}

/// Thins dense scans, measures the points, and labels those that may be the tree.
template <class Tag>
void start_labels(Session_state<Tag>& s)
{
  if (s.options.do_thin && s.scan.size() >= s.options.thinning.fewest)
    thin_dense_points<Tag>(s.is_wood, s.options.thinning, s.scan);
  measure_points<Tag>(s.scan);
  s.labels.start(s.is_wood);
}

/// Sets the method of all further stages. It is reported once it is known.
template <class Tag>
void set_method(Session_state<Tag>& s, Skeleton_method method)
{
  s.options.method = method;
  if (method != Skeleton_method::automatic)
    s.report.method = method;
  if (method == Skeleton_method::level_sets)
    s.options.layers.thickness = blade_layer_thickness;
}

/// Returns whether leaf blades can be told from other sheets, and no option says there is wood.
template <class Tag>
bool may_have_blades(const Session_state<Tag>& s)
{
  const Session_options& o = s.options;
  return o.do_mark_ground && o.do_trace_paths && !o.given &&
         o.leaf_removal == Leaf_removal::where_found;
}

/// Expresses the hints in coordinates of the scan.
template <class Tag>
void localize_hints(Session_state<Tag>& s)
{
  const Scan_frame& frame = s.scan.frame;
  Session_options& o = s.options;
  o.up = Vec3::UnitZ();
  o.breast_height /= frame.unit;
  if (o.given) { // the given skeleton is the tree, and its first point is the root
    s.may_be_tree = s.is_used();
    o.method = Skeleton_method::chains;
    if (!o.root)
      o.root = o.given->points.front();
  }
  if (o.method == Skeleton_method::automatic && !may_have_blades(s))
    o.method = Skeleton_method::chains;
  set_method(s, o.method);
  for (Vec3& scanner : o.scanners)
    scanner = frame.to_local(scanner);
}

// ---- paths

/// Returns the given root in coordinates of the scan.
template <class Tag>
std::optional<Vec3> root_hint(const Session_state<Tag>& s)
{
  if (!s.options.root)
    return std::nullopt;
  return s.scan.frame.to_local(*s.options.root);
}

template <class Tag>
Compact_links used_links(const Session_state<Tag>& s)
{
  return Compact_links(Tag(), s.scan, s.is_used(), s.options.axes.links);
}

/// What is known about the root before the neighbour graph is built.
enum class Known_root { none, foot_on_ground, points };

/// Builds the graph of the used points, and finds the root unless its points are known.
template <class Tag>
void link_used(Session_state<Tag>& s,
               const Compact_links& links,
               Known_root known,
               Linked_parts& linked)
{
  const Session_options& o = s.options;
  const auto find_root = [&](const Point_parts& parts) {
    if (known != Known_root::points)
      s.root =
          points_of_root<Tag>(s.scan,
                              s.is_used(),
                              links,
                              parts,
                              root_hint(s),
                              known == Known_root::foot_on_ground ? s.clutter.foot() : std::nullopt,
                              o.up,
                              o.layers);
  };
  link_parts<Tag>(s.scan, s.is_used(), links, o.axes.links, find_root, linked);
}

template <class Tag>
void trace_layers(Session_state<Tag>& s, Compact_links& links, Linked_parts& linked)
{
  s.paths = skeleton::trace_layers<Tag>(s.scan, s.root, s.options.layers, links, linked, s.layers);
}

/// Removes the ground and flat faces, and links the remaining points. Returns `false` if `progress`
/// stopped it; in this case, the ground is not removed.
template <class Tag>
bool remove_ground(Session_state<Tag>& s,
                   Compact_links& links,
                   Linked_parts& linked,
                   pcs::internal::Progress& progress)
{
  const auto link = [&](Known_root known) {
    if (s.options.do_trace_paths)
      link_used(s, links, known, linked);
  };
  if (s.options.do_mark_ground) // links meanwhile, since most scans have no ground
    s.clutter.mark_ground(links, s.options.up, [&] { link(Known_root::none); });
  else
    link(Known_root::none);
  if (!progress(end_of_clutter))
    return false;
  if (s.clutter.remove_ground_and_faces([&] { return used_links(s); }, links))
    link(Known_root::foot_on_ground);
  return true;
}

// ---- axes

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
    const double width = end_of_axes - end_of_first_fit;
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

/// Fits the axes of all branches, removes leaves, fuses pieces of the same axis, and continues
/// thick axes through wood with few points.
template <class Tag>
bool fit_all_axes(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  if (!fit_wood(s, progress))
    return false;
  restore_wood(s);
  fuse_axes<Tag>(s.scan.spacing, s.options.branching.fusion, s.axes);
  s.report.number_of_unexplained_thick_points =
      follow_thick_ends(s.scan, s.options.axes.chains, s.options.thick_ends, s.root, s.axes)
          .number_of_unexplained_points;
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

// ---- joints

template <class Tag>
bool build_tree(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  const Session_options& o = s.options;
  if (s.axes.axes.empty())
    return true;
  const auto joining = [&](double f) {
    return progress(end_of_axes + (end_of_joints - end_of_axes) * f);
  };
  if (!build_branch_tree<Tag>(s.scan, s.root, root_hint(s), o.branching, joining, s.axes, s.joined))
    return false;
  if (s.leaves.has_leaves && s.leaves.rounds > 0) // remaining leaves make twigs thick
    s.options.radii.support.pipes.slack = o.leaves.pipe_slack;
  refine_radii<Tag>(s.scan, s.is_used(), s.axes, o.radii, s.joined.tree);
  if (!o.given) // a given skeleton is one tree
    s.report.number_of_other_stems =
        count_other_stems(s.axes, s.joined.joints, s.joined.root, s.joined.tree, o.stems);
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
  const auto is_tree = [&s](Index i) { return s.is_used()[i] != 0 || s.labels.is_leaf(i); };
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

#endif // PCS_SKELETON_SESSION_STAGES_H
