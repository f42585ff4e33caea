// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ties samples to the border of a handle where it runs, not to the nearest sample inside.

#ifndef PCS_DEFORMATION_HANDLES_ADD_BOUNDARY_NODES_H
#define PCS_DEFORMATION_HANDLES_ADD_BOUNDARY_NODES_H

#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/handles/Border_finder.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// A boundary node is taken to lie at least this far from its sample, in units of `typical_edge()`.
constexpr double shortest_boundary_edge = 0.1;

/// What `add_boundary_nodes()` reads. `handle_of_site(site)` is the handle that prescribes a site
/// on a border.
template <class HandleOfSite, class SitePosition>
struct Boundary_input
{
  const Elastic_network& network; ///< over the samples
  double weight_unit;             ///< weight of an edge whose border is as long as itself
  const std::vector<Border_edge>& border;
  const std::vector<std::uint32_t>& sample_of_site;
  HandleOfSite handle_of_site;
  SitePosition site_position;
};

namespace internal {

/// A place where the region of a sample meets a handle; several edges of the site graph join in
/// one.
struct Border_crossing
{
  std::uint32_t sample; ///< whose region lies outside the handle there
  std::uint32_t beyond; ///< whose region lies inside; may be the same
  Node_constraint handle;
  std::uint32_t site; ///< in the handle
  double length;      ///< of the edge that crosses [L]
};

} // namespace internal

/*!
  Returns the network with nodes added on the borders of exact handles, and extends `constraints` to
  them.

  With few samples the nearest sample in a handle lies well inside it, and the body would yield as
  if the handle ended there. A boundary node sits at the handle's point that is nearest to the free
  sample, is prescribed like the handle, and takes over the border between the two regions at its
  true distance. Costs one pass over the border.
*/
template <class HandleOfSite, class SitePosition>
Elastic_network add_boundary_nodes(const Boundary_input<HandleOfSite, SitePosition>& in,
                                   Node_constraints& constraints)
{
  using internal::Border_crossing;
  const std::size_t number_of_samples = in.network.size();
  const Weighted_graph& base = in.network.surface;
  std::vector<Border_crossing> crossings;
  crossings.reserve(in.border.size());
  for (const Border_edge& e : in.border)
    if (in.sample_of_site[e.inside] != no_sample)
      crossings.push_back({in.sample_of_site[e.outside],
                           in.sample_of_site[e.inside],
                           in.handle_of_site(e.inside),
                           e.inside,
                           (in.site_position(e.outside) - in.site_position(e.inside)).norm()});
  std::sort(crossings.begin(),
            crossings.end(),
            [](const Border_crossing& a, const Border_crossing& b) {
              return std::tie(a.beyond, a.handle, a.sample, a.site, a.length) <
                     std::tie(b.beyond, b.handle, b.sample, b.site, b.length);
            });

  Elastic_network result;
  result.rest = in.network.rest;
  result.links = in.network.links;
  result.area = in.network.area;
  result.surface_rank = in.network.surface_rank;
  result.rank = in.network.rank;
  struct Edge
  {
    std::uint32_t from, to;
    double weight;
  };
  std::vector<Edge> edges;
  const double edge = typical_edge(in.network.rest, base);

  const auto add_node = [&](std::size_t s, std::uint32_t site, Node_constraint h, double border) {
    const auto node = static_cast<std::uint32_t>(result.rest.size());
    result.rest.push_back(in.site_position(site));
    constraints.handle_of_node.push_back(h);
    const double distance =
        std::max(shortest_boundary_edge * edge, (result.rest.back() - in.network.rest[s]).norm());
    edges.push_back({static_cast<std::uint32_t>(s),
                     node,
                     representable_weight(in.weight_unit * border / distance)});
    edges.push_back({node, static_cast<std::uint32_t>(s), edges.back().weight});
  };
  const auto is_free = [&](std::size_t s) { return !constraints.is_prescribed(s); };

  // Borders that run through regions of free samples.
  for (std::size_t c = 0; c < crossings.size();) {
    const Border_crossing& key = crossings[c];
    double border = 0, nearest = std::numeric_limits<double>::infinity();
    std::uint32_t site = key.site;
    std::size_t end = c;
    for (; end < crossings.size() && crossings[end].beyond == key.beyond &&
           crossings[end].handle == key.handle && crossings[end].sample == key.sample;
         ++end) {
      border += crossings[end].length;
      const double d =
          (in.site_position(crossings[end].site) - in.network.rest[key.sample]).squaredNorm();
      if (d < nearest) {
        nearest = d;
        site = crossings[end].site;
      }
    }
    if (is_free(key.sample) && is_free(key.beyond))
      add_node(key.sample, site, key.handle, border);
    c = end;
  }
  // Edges of the sample graph; those into a handle end at its border if it runs through the region
  // over there.
  for (std::size_t s = 0; s < number_of_samples; ++s)
    for (std::size_t e = base.first[s]; e < base.first[s + 1]; ++e) {
      const std::uint32_t t = base.neighbor[e];
      const bool leads_into_handle = is_free(s) && !is_free(t);
      const bool leads_out = !is_free(s) && is_free(t);
      if (!leads_into_handle && !leads_out) {
        edges.push_back({static_cast<std::uint32_t>(s), t, base.weight[e]});
        continue;
      }
      const std::uint32_t inside = leads_out ? static_cast<std::uint32_t>(s) : t;
      const std::size_t outside = leads_out ? t : s;
      const Node_constraint h = constraints.handle_of_node[inside];
      auto crossing =
          std::lower_bound(crossings.begin(),
                           crossings.end(),
                           std::make_pair(inside, h),
                           [](const Border_crossing& a, const auto& key) {
                             return std::tie(a.beyond, a.handle) < std::tie(key.first, key.second);
                           });
      double nearest = std::numeric_limits<double>::infinity();
      std::uint32_t site = no_sample;
      for (; crossing != crossings.end() && crossing->beyond == inside && crossing->handle == h;
           ++crossing) {
        const double d =
            (in.site_position(crossing->site) - in.network.rest[outside]).squaredNorm();
        if (d < nearest) {
          nearest = d;
          site = crossing->site;
        }
      }
      if (site == no_sample)
        edges.push_back({static_cast<std::uint32_t>(s), t, base.weight[e]});
      else if (leads_into_handle)
        add_node(s,
                 site,
                 h,
                 base.weight[e] / in.weight_unit *
                     (in.network.rest[t] - in.network.rest[s]).norm());
    }

  Weighted_graph& surface = result.surface;
  surface.first.assign(result.rest.size() + 1, 0);
  for (const Edge& e : edges)
    ++surface.first[e.from + 1];
  for (std::size_t i = 0; i < result.rest.size(); ++i)
    surface.first[i + 1] += surface.first[i];
  std::vector<Edge> ordered(edges.size());
  std::vector<std::size_t> at(surface.first.begin(), surface.first.end() - 1);
  for (const Edge& e : edges)
    ordered[at[e.from]++] = e;
  for (std::size_t i = 0; i < result.rest.size(); ++i)
    std::sort(ordered.begin() + static_cast<std::ptrdiff_t>(surface.first[i]),
              ordered.begin() + static_cast<std::ptrdiff_t>(surface.first[i + 1]),
              [](const Edge& a, const Edge& b) { return a.to < b.to; });
  for (const Edge& e : ordered) {
    surface.neighbor.push_back(e.to);
    surface.weight.push_back(e.weight);
  }
  if (result.links.size() > 0)
    result.links.first.resize(result.rest.size() + 1, result.links.first.back());
  return result;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_ADD_BOUNDARY_NODES_H
