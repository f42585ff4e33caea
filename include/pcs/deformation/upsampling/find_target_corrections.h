// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the points that targets of handles move, and the points that are blended towards them.

#ifndef PCS_DEFORMATION_UPSAMPLING_FIND_TARGET_CORRECTIONS_H
#define PCS_DEFORMATION_UPSAMPLING_FIND_TARGET_CORRECTIONS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/Site_constraints.h>
#include <pcs/deformation/handles/Target_field.h>
#include <pcs/deformation/model/Target_offset.h>
#include <pcs/deformation/upsampling/Target_corrections.h>
#include <pcs/deformation/upsampling/border_fade.h>
#include <pcs/deformation/upsampling/extend_targets.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

/// Adds the sites that move with the handle. The others, of soft handles, are blended.
inline void add_handle(const std::vector<std::uint32_t>& of_handle,
                       const std::vector<Vec3>& targets,
                       const Target_field& field,
                       const Site_constraints& sites,
                       Target_corrections& corrections)
{
  for (std::size_t k = 0; k < of_handle.size(); ++k)
    if (sites[of_handle[k]] >= 0) {
      corrections.add_target(of_handle[k], *field.of_site(of_handle[k]), targets[k]);
    }
}

/// Adds the sites of fragments that follow a handle: they get the mean offset of its sites there.
template <class ConcurrencyTag>
void add_followers(const Sampled_body<ConcurrencyTag>& body,
                   const Handle_set& handles,
                   const Target_field& field,
                   const Site_constraints& sites,
                   Target_corrections& corrections)
{
  std::vector<double> count(body.number_of_components(), 0);
  std::vector<Target_offset> mean(body.number_of_components());
  const auto follows = [&](std::size_t site) { return sites[site] != handles.of_site(site); };
  const auto is_in_fragment = [&](std::size_t site) {
    return body.sample_of_site[site] == no_sample && sites[site] >= 0;
  };
  for (std::size_t site = 0; site < body.number_of_sites(); ++site)
    if (is_in_fragment(site) && !follows(site) && field.of_site(site)) {
      const std::uint32_t c = body.component_of_site[site];
      count[c] += 1;
      mean[c].blend(1 / count[c], *field.of_site(site));
    }
  for (std::size_t site = 0; site < body.number_of_sites(); ++site)
    if (is_in_fragment(site) && follows(site) && count[body.component_of_site[site]] > 0)
      corrections.add(site, mean[body.component_of_site[site]]);
}

template <class ConcurrencyTag, class HandleOfSite>
void add_fades(const Sampled_body<ConcurrencyTag>& body,
               const std::vector<Similarity>& transforms,
               const Target_field& field,
               const std::vector<Border_fade>& fades,
               const HandleOfSite& handle_of_site,
               Target_corrections& corrections)
{
  const auto position = [&](std::size_t site) { return body.rest_of_site(site); };
  const std::vector<Target_offset> offset =
      extend_targets(body.site_graph, fades, field, transforms, handle_of_site, position);
  for (std::size_t f = 0; f < fades.size();) {
    const std::uint32_t site = fades[f].site;
    Target_offset sum;
    for (; f < fades.size() && fades[f].site == site; ++f)
      sum.blend(fades[f].weight, offset[f]);
    if (!sum.is_zero())
      corrections.add(site, sum);
  }
}

} // namespace internal

/// Finds the corrections of the current shape; none without targets. O(sites) if there are targets.
template <class ConcurrencyTag, class HandleOfSite>
void find_target_corrections(const Sampled_body<ConcurrencyTag>& body,
                             const Handle_set& handles,
                             const std::vector<std::shared_ptr<const Handle_targets>>& targets,
                             const std::vector<Similarity>& transforms,
                             const Target_field& field,
                             const Site_constraints& sites,
                             const std::vector<Border_fade>& fades,
                             const HandleOfSite& handle_of_site,
                             Target_corrections& corrections)
{
  corrections.clear();
  if (field.empty())
    return;
  corrections.assign(body.number_of_sites());
  for (std::size_t h = 0; h < targets.size(); ++h)
    if (targets[h])
      internal::add_handle(handles.points()[h]->sites,
                           targets[h]->of_sites,
                           field,
                           sites,
                           corrections);
  if (body.has_fragments)
    internal::add_followers(body, handles, field, sites, corrections);
  if (body.is_sampled)
    internal::add_fades(body, transforms, field, fades, handle_of_site, corrections);
  corrections.mark_blocks(body.site_of_place);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_FIND_TARGET_CORRECTIONS_H
