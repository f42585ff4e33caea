// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fades the exact motion of a handle into the blended motion of the points around it.

#ifndef PCS_DEFORMATION_BORDER_FADE_H
#define PCS_DEFORMATION_BORDER_FADE_H

#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Harmonic_system.h>
#include <pcs/deformation/Sample_regions.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace deformation {

/// A site that follows a handle by the share `weight` in (0, 1].
struct Border_fade
{
  std::uint32_t site;
  Node_constraint handle;
  double weight;
};

/*!
  Free sites nearer to an exact handle, along the graph, than one sample spacing `r`: their share is
  `(1 - (d / r)^2)^2`, which is one at the border and leaves smoothly. Without it the handle's points, which are
  placed exactly, part from their neighbours, which are blended from samples. Increasing by site. Costs the width of
  the band only.
  \param handle_of_site the handle that prescribes a site, or negative
  \param spacing_of_sample mean distance of each sample to its neighbours [L]
*/
template <class HandleOfSite, class SitePosition>
std::vector<Border_fade> border_fades(const neighborhood::Proximity_graph& graph,
                                      const std::vector<std::uint32_t>& sample_of_site,
                                      const std::vector<double>& spacing_of_sample,
                                      const HandleOfSite& handle_of_site,
                                      const SitePosition& position)
{
  struct Reached
  {
    double distance = std::numeric_limits<double>::infinity();
    double radius = 0;
    Node_constraint handle = free_node;
  };
  struct Entry
  {
    double distance;
    std::uint32_t site;
  };
  std::vector<std::uint32_t> index(graph.size(), no_sample); // of a site in `reached`
  std::vector<Reached> reached;
  // Sites wait in buckets of distance; one may wait more than once, and is left alone if it came nearer meanwhile.
  double largest_radius = 0;
  for (const double r : spacing_of_sample)
    largest_radius = std::max(largest_radius, r);
  constexpr std::size_t number_of_buckets = 256;
  const double width = largest_radius > 0 ? largest_radius / number_of_buckets : 1;
  std::vector<std::vector<Entry>> buckets(number_of_buckets);
  const auto relax = [&](std::size_t from, std::uint32_t to, const Reached& source) {
    const double d = source.distance + (position(to) - position(from)).norm();
    if (!(d < source.radius))
      return;
    if (index[to] == no_sample) {
      index[to] = static_cast<std::uint32_t>(reached.size());
      reached.emplace_back();
    }
    Reached& r = reached[index[to]];
    if (d < r.distance) {
      r = {d, source.radius, source.handle};
      buckets[std::min(number_of_buckets - 1, static_cast<std::size_t>(d / width))].push_back(
          {d, to});
    }
  };
  for (std::size_t site = 0; site < graph.size(); ++site) {
    const Node_constraint h = handle_of_site(site);
    if (h < 0 || sample_of_site[site] == no_sample)
      continue;
    const Reached source{0, spacing_of_sample[sample_of_site[site]], h};
    for (auto j = graph.begin(site); j != graph.end(site); ++j)
      if (handle_of_site(*j) < 0)
        relax(site, *j, source);
  }
  for (auto& bucket : buckets)
    for (std::size_t b = 0; b < bucket.size(); ++b) { // grows while it is read
      const Entry entry = bucket[b];
      const Reached r = reached[index[entry.site]];
      if (entry.distance > r.distance)
        continue;
      for (auto j = graph.begin(entry.site); j != graph.end(entry.site); ++j)
        if (handle_of_site(*j) < 0)
          relax(entry.site, *j, r);
    }
  std::vector<Border_fade> fades;
  for (std::size_t site = 0; site < graph.size(); ++site)
    if (index[site] != no_sample) {
      const Reached& r = reached[index[site]];
      const double f = 1 - (r.distance / r.radius) * (r.distance / r.radius);
      fades.push_back({static_cast<std::uint32_t>(site), r.handle, f * f});
    }
  return fades;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BORDER_FADE_H
