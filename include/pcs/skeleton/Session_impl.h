// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The pipeline of a skeletonization: definitions of Session.h.

#ifndef PCS_SKELETON_SESSION_IMPL_H
#define PCS_SKELETON_SESSION_IMPL_H

#include <pcs/internal/Stage_timer.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/stages/axis_stage.h>
#include <pcs/skeleton/stages/branch_stage.h>
#include <pcs/skeleton/stages/choose_method.h>
#include <pcs/skeleton/stages/neighbor_stage.h>
#include <pcs/skeleton/stages/path_stage.h>
#include <pcs/skeleton/stages/stage_progress.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

template <class ConcurrencyTag>
Session<ConcurrencyTag>::Session(std::vector<Vec3> input,
                                 std::vector<std::uint8_t> is_wood,
                                 Session_hints hints)
  : Session(std::move(input), std::move(is_wood), Session_options(std::move(hints)))
{
}

template <class ConcurrencyTag>
Session<ConcurrencyTag>::Session(std::vector<Vec3> input,
                                 std::vector<std::uint8_t> is_wood,
                                 Session_options options)
  : m_state(std::make_unique<Session_state<ConcurrencyTag>>())
{
  m_state->report.number_of_points = input.size();
  m_state->input = std::move(input);
  m_state->is_wood = std::move(is_wood);
  if (options.method != Skeleton_method::automatic)
    m_state->report.method = options.method;
  m_state->report.is_root_given = options.root.has_value();
  m_state->report.is_skeleton_given = options.given.has_value();
  m_state->options = std::move(options);
}

template <class ConcurrencyTag>
Session<ConcurrencyTag>::~Session() = default;

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::find_neighbors(pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  if (s.stage >= Stage::neighbors)
    return true;
  const pcs::internal::Stage_timer timer(s.report.seconds.neighbors);
  if (!progress(0))
    return false;
  if (s.scan.points.empty())
    internal::take_points(s);
  if (!internal::register_stations(s, progress))
    return false;
  internal::start_labels(s);
  internal::localize_hints(s);
  return internal::finish(s, Stage::neighbors, internal::end_of_neighbors, progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::find_paths(pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  if (!find_neighbors(progress) || s.stage >= Stage::paths)
    return s.stage >= Stage::paths;
  const pcs::internal::Stage_timer timer(s.report.seconds.paths);
  if (s.options.do_mark_ground && !s.clutter.remove_walls_and_roofs(s.options.up))
    return internal::finish(s, Stage::paths, internal::end_of_paths, progress);
  Compact_links links = internal::used_links(s);
  Linked_parts linked;
  if (!internal::remove_ground(s, links, linked, progress))
    return false;
  internal::find_blades(s);
  if (s.options.do_trace_paths)
    internal::trace_layers(s, links, linked);
  return internal::finish(s, Stage::paths, internal::end_of_paths, progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::fit_axes(pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  if (!find_paths(progress) || s.stage >= Stage::axes)
    return s.stage >= Stage::axes;
  const pcs::internal::Stage_timer timer(s.report.seconds.axes);
  if (s.root.empty()) // without a root, no point belongs to a tree
    return internal::finish(s, Stage::axes, internal::end_of_axes, progress);
  if (s.options.method == Skeleton_method::automatic && !internal::choose_method(s, progress))
    return false;
  if (s.has_axes() && !internal::fit_all_axes(s, progress))
    return false;
  if (s.options.method == Skeleton_method::sections && !internal::find_sections(s, progress))
    return false;
  return internal::finish(s, Stage::axes, internal::end_of_axes, progress);
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::join(pcs::internal::Progress& progress)
{
  Session_state<ConcurrencyTag>& s = *m_state;
  if (!fit_axes(progress) || s.stage >= Stage::joints)
    return s.stage >= Stage::joints;
  if (!s.has_axes() && !s.root.empty())
    return internal::join_centers(s, progress);
  if (!internal::join_branches(s, progress))
    return false;
  internal::measure_sections(s);
  s.stage = Stage::joints;
  return true;
}

template <class ConcurrencyTag>
const Scan& Session<ConcurrencyTag>::scan() const
{
  return m_state->scan;
}

template <class ConcurrencyTag>
const Layer_tree& Session<ConcurrencyTag>::layers() const
{
  return m_state->layers;
}

template <class ConcurrencyTag>
const Axis_set& Session<ConcurrencyTag>::axes() const
{
  return m_state->axes;
}

template <class ConcurrencyTag>
const std::vector<Joint>& Session<ConcurrencyTag>::joints() const
{
  return m_state->joined.joints;
}

template <class ConcurrencyTag>
const Branch_tree& Session<ConcurrencyTag>::tree() const
{
  return m_state->joined.tree;
}

template <class ConcurrencyTag>
const Skeleton_report& Session<ConcurrencyTag>::report() const
{
  return m_state->report;
}

template <class ConcurrencyTag>
const std::vector<std::uint8_t>& Session<ConcurrencyTag>::used_points() const
{
  return m_state->is_used();
}

template <class ConcurrencyTag>
void Session<ConcurrencyTag>::release_neighbors()
{
  Scan& scan = m_state->scan;
  decltype(scan.neighbors)().swap(scan.neighbors);
  scan.search.reset();
}

template <class ConcurrencyTag>
Index Session<ConcurrencyTag>::node_of_input(std::size_t i) const
{
  return tree().node_of_point[scan().point_of_input[i]];
}

template <class ConcurrencyTag>
Vec3 Session<ConcurrencyTag>::normal_of_input(std::size_t i) const
{
  const Vec3 across =
      offset_of_point(tree(), m_state->successors, node_of_input(i), scan().position_of_input(i));
  const double length = across.norm();
  return length > 0 ? scan().frame.direction_to_input(across / length) : Vec3(Vec3::Zero());
}

template <class ConcurrencyTag>
double Session<ConcurrencyTag>::residual_of_input(std::size_t i) const
{
  return scan().frame.unit * residual_of_point(tree(),
                                               m_state->successors,
                                               node_of_input(i),
                                               scan().position_of_input(i));
}

template <class ConcurrencyTag>
bool Session<ConcurrencyTag>::is_leaf_of_input(std::size_t i) const
{
  return m_state->labels.is_leaf(scan().point_of_input[i]);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_IMPL_H
