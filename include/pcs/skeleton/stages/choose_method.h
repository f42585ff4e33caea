// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Choice between the methods `chains` and `level_sets`, by leaf blades.

#ifndef PCS_SKELETON_STAGES_CHOOSE_METHOD_H
#define PCS_SKELETON_STAGES_CHOOSE_METHOD_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/Session_state.h>
#include <pcs/skeleton/model/Moments.h>
#include <pcs/skeleton/stages/neighbor_stage.h>
#include <pcs/skeleton/stages/path_stage.h>
#include <pcs/skeleton/stages/stage_progress.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Finds leaf blades if they decide on the method; without them, it is `chains`.
template <class Tag>
void find_blades(Session_state<Tag>& s)
{
  if (s.options.method != Skeleton_method::automatic)
    return;
  s.blades = find_leaf_blades<Tag>(s.scan, s.is_used(), s.options.blades);
  const bool is_rounded = s.report.coordinate_step > s.scan.frame.unit * s.blades.cell;
  if (is_rounded || s.blades.share < s.options.blades.share) // rounded points lie in planes
    set_method(s, Skeleton_method::chains);
}

/// Keeps the blades of the largest connected part, which is the plant, unless they stand on the
/// ground like walls. Other parts may be objects beside it.
template <class Tag>
void keep_blades_of_plant(Session_state<Tag>& s)
{
  const Compact_links links = used_links(s);
  const Point_parts parts = connected_parts<Tag>(s.is_used(), links);
  const auto largest = std::max_element(parts.size.begin(), parts.size.end());
  const auto plant = static_cast<Index>(largest - parts.size.begin());
  std::vector<Index>& points = s.blades.points;
  std::vector<std::uint8_t> is_blade(s.scan.size(), 0);
  for (const Index i : points)
    is_blade[i] = 1;
  const Point_parts blades = connected_parts<Tag>(is_blade, links);
  std::map<Index, Moments> feet; // the points near the ground, by blade
  const Ground& ground = s.clutter.ground();
  if (ground.foot)
    for (const Index i : points)
      if (ground.height(s.scan.points[i]) <= s.blades.radius)
        feet[blades.part[i]].add(s.scan.points[i]);
  const auto is_standing = [&](Index i) {
    const auto foot = feet.find(blades.part[i]);
    return foot != feet.end() &&
           foot->second.covariance().trace() >= s.blades.radius * s.blades.radius;
  };
  const double count = double(points.size());
  points.erase(std::remove_if(points.begin(),
                              points.end(),
                              [&](Index i) { return parts.part[i] != plant || is_standing(i); }),
               points.end());
  s.blades.share *= double(points.size()) / count;
}

/// Chooses the method of a plant with sheets: `level_sets`, unless thick axes explain the sheets,
/// like the bark of a log, or most of them are not connected with the plant. Returns `false` if
/// `progress` stopped it.
template <class Tag>
bool choose_method(Session_state<Tag>& s, pcs::internal::Progress& progress)
{
  bool is_running = true;
  const Axis_set axes = skeleton::fit_axes<Tag>(s.scan, s.layers, s.options.axes, [&](double) {
    return is_running = progress(end_of_paths);
  });
  if (!is_running)
    return false;
  keep_blades_of_plant(s);
  const Blade_options& rules = s.options.blades;
  const double bark = share_of_bark(s.scan, axes, s.blades, rules);
  const double share = (1 - bark) * s.blades.share;
  if (bark > rules.bark || share < rules.share) {
    set_method(s, Skeleton_method::chains);
    return true;
  }
  set_method(s, Skeleton_method::level_sets);
  s.report.blade_fraction = share;
  Compact_links links = used_links(s);
  Linked_parts linked;
  link_used(s, links, Known_root::foot_on_ground, linked);
  trace_layers(s, links, linked);
  return true;
}

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_STAGES_CHOOSE_METHOD_H
