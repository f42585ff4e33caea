// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Second stage of a skeletonization: ground, graph of neighbours, root, level sets.

#ifndef PCS_SKELETON_STAGES_PATH_STAGE_H
#define PCS_SKELETON_STAGES_PATH_STAGE_H

#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/stages/stage_progress.h>

#include <optional>

namespace pcs {
namespace skeleton {

namespace internal {

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
    s.clutter.mark_ground(links, s.options.up, root_hint(s), [&] { link(Known_root::none); });
  else
    link(Known_root::none);
  if (!progress(end_of_clutter))
    return false;
  if (s.clutter.remove_ground_and_faces([&] { return used_links(s); }, links))
    link(Known_root::foot_on_ground);
  return true;
}

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_STAGES_PATH_STAGE_H
