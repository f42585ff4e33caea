// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fades the exact motion of a handle into the blended motion of the points around it.

#ifndef PCS_DEFORMATION_BORDER_FADE_H
#define PCS_DEFORMATION_BORDER_FADE_H

#include <pcs/deformation/Border_finder.h>
#include <pcs/deformation/Elastic_network.h>
#include <pcs/deformation/Harmonic_system.h>
#include <pcs/deformation/Sample_regions.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
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
  \param border edges from sites of exact handles to others
  \param handle_of_site the handle that prescribes a site, or negative
  \param spacing_of_sample mean distance of each sample to its neighbours [L]
*/
template <class HandleOfSite, class SitePosition>
std::vector<Border_fade> border_fades(const neighborhood::Proximity_graph& graph,
                                      const std::vector<Border_edge>& border,
                                      const std::vector<std::uint32_t>& sample_of_site,
                                      const std::vector<double>& spacing_of_sample,
                                      const HandleOfSite& handle_of_site,
                                      const SitePosition& position)
{
  struct Reached
  {
    Vec3 position;
    double distance;
    double radius;
    Node_constraint handle;
    std::uint32_t site;
  };
  struct Entry
  {
    double distance;
    std::uint32_t reached;
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
  const auto relax = [&](const Reached& source, std::uint32_t to) {
    std::uint32_t r = index[to];
    if (r == no_sample) {
      const Vec3 p = position(to);
      const double d = source.distance + (p - source.position).norm();
      if (!(d < source.radius) || handle_of_site(to) >= 0)
        return;
      r = index[to] = static_cast<std::uint32_t>(reached.size());
      reached.push_back({p, d, source.radius, source.handle, to});
    } else {
      if (reached[r].distance <= source.distance)
        return;
      const double d = source.distance + (reached[r].position - source.position).norm();
      if (!(d < source.radius && d < reached[r].distance))
        return;
      reached[r].distance = d;
      reached[r].radius = source.radius;
      reached[r].handle = source.handle;
    }
    const double d = reached[r].distance;
    buckets[std::min(number_of_buckets - 1, static_cast<std::size_t>(d / width))].push_back({d, r});
  };
  for (const Border_edge& e : border)
    if (sample_of_site[e.inside] != no_sample)
      relax({position(e.inside),
             0,
             spacing_of_sample[sample_of_site[e.inside]],
             handle_of_site(e.inside),
             e.inside},
            e.outside);
  for (auto& bucket : buckets)
    for (std::size_t b = 0; b < bucket.size(); ++b) { // grows while it is read
      const Entry entry = bucket[b];
      const Reached source = reached[entry.reached];
      if (entry.distance > source.distance)
        continue;
      for (auto j = graph.begin(source.site); j != graph.end(source.site); ++j)
        relax(source, *j);
    }
  std::vector<Border_fade> fades;
  fades.reserve(reached.size());
  for (std::size_t site = 0; site < index.size(); ++site)
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
