// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of the offsets of targets from a handle to the free sites around it.

#ifndef PCS_DEFORMATION_UPSAMPLING_EXTEND_TARGETS_H
#define PCS_DEFORMATION_UPSAMPLING_EXTEND_TARGETS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/handles/Target_field.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/deformation/model/Node_targets.h>
#include <pcs/deformation/upsampling/border_fade.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Returns for each fade the offset of the handle at its site. The sites are visited in the order of
  their distances from the handle. The offset at a site is the mean of the offsets at its neighbours
  that are nearer to the handle or belong to it, each continued along its gradient, with the inverse
  squared distances of the neighbours as weights. O(f log f) for `f` fades of constant degree.

  \param fades increasing by site, then by handle
  \param handle_of_site the exact handle that holds a site, or negative
  \param transforms of the handles
*/
template <class HandleOfSite, class SitePosition>
std::vector<Target_offset> extend_targets(const neighborhood::Proximity_graph& graph,
                                          const std::vector<Border_fade>& fades,
                                          const Target_field& field,
                                          const std::vector<Similarity>& transforms,
                                          const HandleOfSite& handle_of_site,
                                          const SitePosition& position)
{
  std::vector<Target_offset> offset(fades.size());
  std::vector<std::uint32_t> order(fades.size());
  for (std::size_t f = 0; f < order.size(); ++f)
    order[f] = static_cast<std::uint32_t>(f);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return fades[a].distance < fades[b].distance;
  });
  std::vector<char> is_known(fades.size(), 0);
  const auto known_fade = [&](std::uint32_t site, Node_constraint handle) -> const Target_offset* {
    const auto f = std::lower_bound(
        fades.begin(),
        fades.end(),
        std::make_tuple(site, handle),
        [](const Border_fade& a, const auto& key) { return std::tie(a.site, a.handle) < key; });
    const auto at = static_cast<std::size_t>(f - fades.begin());
    const bool is_found = f != fades.end() && f->site == site && f->handle == handle;
    return is_found && is_known[at] ? &offset[at] : nullptr;
  };
  for (const std::uint32_t f : order) {
    const Border_fade& fade = fades[f];
    const Similarity& t = transforms[static_cast<std::size_t>(fade.handle)];
    const Vec3 place = position(fade.site);
    double sum = 0;
    for (auto j = graph.begin(fade.site); j != graph.end(fade.site); ++j) {
      const bool is_held = handle_of_site(*j) == fade.handle;
      const Target_offset* near = is_held ? field.of_site(*j) : known_fade(*j, fade.handle);
      const Vec3 step = place - position(*j);
      if (!near || !(step.squaredNorm() > 0))
        continue;
      const double weight = 1 / step.squaredNorm();
      sum += weight;
      offset[f].blend(weight / sum,
                      {near->offset_at(t.scale() * (t.rotation() * step)), near->linear});
    }
    is_known[f] = 1;
  }
  return offset;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_EXTEND_TARGETS_H
