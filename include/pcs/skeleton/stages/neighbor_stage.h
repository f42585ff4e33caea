// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// First stage of a skeletonization: points, registration, spacing, labels.

#ifndef PCS_SKELETON_STAGES_NEIGHBOR_STAGE_H
#define PCS_SKELETON_STAGES_NEIGHBOR_STAGE_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/branching/level_set_skeleton.h>
#include <pcs/skeleton/scan/measure_coordinate_step.h>
#include <pcs/skeleton/scan/prepare_scan.h>
#include <pcs/skeleton/scan/thin_dense_points.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

template <class ConcurrencyTag>
class Session; // the draft is one; its header includes this one

namespace internal {

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
  options.coarse_axes.factors.clear();
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

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_STAGES_NEIGHBOR_STAGE_H
