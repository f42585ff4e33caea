// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Boundary nodes: connect samples to the border of a handle at its true distance.

#ifndef PCS_DEFORMATION_HANDLES_ADD_BOUNDARY_NODES_H
#define PCS_DEFORMATION_HANDLES_ADD_BOUNDARY_NODES_H

#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/handles/Border_finder.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/internal/compress_rows.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// Smallest distance of a boundary node from its sample that enters weights, in units of
/// `typical_edge()`.
constexpr double shortest_boundary_edge = 0.1;

/// Input of `add_boundary_nodes()`. `handle_of_site(site)` is the handle that prescribes a site
/// on a border.
template <class HandleOfSite, class SitePosition>
struct Boundary_input
{
  const Elastic_network& network; ///< over the samples
  double weight_unit;             ///< weight of an edge as long as the border that it crosses
  const std::vector<Border_edge>& border;
  const std::vector<std::uint32_t>& sample_of_site;
  HandleOfSite handle_of_site;
  SitePosition site_position;
};

namespace internal {

/// An edge of the site graph from the region of a sample into a handle.
struct Border_crossing
{
  std::uint32_t sample; ///< the sample of the region outside the handle
  std::uint32_t beyond; ///< the sample of the region inside; may be the same
  Node_constraint handle;
  std::uint32_t site; ///< in the handle
  double length;      ///< of the edge [L]
};

/// A half-edge of the sample graph.
struct Sample_edge
{
  std::uint32_t from, to;
  double weight;
};

/// Adds the boundary nodes, step by step; see `add_boundary_nodes()`.
template <class HandleOfSite, class SitePosition>
class Boundary_nodes
{
public:
  using Input = Boundary_input<HandleOfSite, SitePosition>;

  Boundary_nodes(const Input& in, Node_constraints& constraints)
    : m_in(in),
      m_constraints(constraints),
      m_typical_edge(typical_edge(in.network.rest, in.network.surface))
  {
    m_result.rest = in.network.rest;
    m_result.links = in.network.links;
    m_result.area = in.network.area;
    m_result.surface_rank = in.network.surface_rank;
    m_result.rank = in.network.rank;
  }

  Elastic_network operator()()
  {
    collect_crossings();
    add_nodes_in_free_regions();
    add_edges();
    fill_rows();
    return std::move(m_result);
  }

private:
  using Crossings = std::vector<Border_crossing>;

  bool is_free(std::size_t s) const { return !m_constraints.is_prescribed(s); }

  /// Squared distance of a crossing from a sample.
  double squared_distance(const Border_crossing& crossing, std::size_t sample) const
  {
    return (m_in.site_position(crossing.site) - m_in.network.rest[sample]).squaredNorm();
  }

  /// Collects the crossings, sorted by the region inside, the handle, and the sample outside.
  void collect_crossings()
  {
    m_crossings.reserve(m_in.border.size());
    for (const Border_edge& e : m_in.border)
      if (m_in.sample_of_site[e.inside] != no_sample)
        m_crossings.push_back(
            {m_in.sample_of_site[e.outside],
             m_in.sample_of_site[e.inside],
             m_in.handle_of_site(e.inside),
             e.inside,
             (m_in.site_position(e.outside) - m_in.site_position(e.inside)).norm()});
    std::sort(m_crossings.begin(),
              m_crossings.end(),
              [](const Border_crossing& a, const Border_crossing& b) {
                return std::tie(a.beyond, a.handle, a.sample, a.site, a.length) <
                       std::tie(b.beyond, b.handle, b.sample, b.site, b.length);
              });
  }

  /// Adds a node at `site`, prescribed like the handle `h`, and its edge to sample `s` across a
  /// border of length `border`.
  void add_node(std::size_t s, std::uint32_t site, Node_constraint h, double border)
  {
    const auto node = static_cast<std::uint32_t>(m_result.rest.size());
    m_result.rest.push_back(m_in.site_position(site));
    m_result.source.push_back(site);
    m_constraints.handle_of_node.push_back(h);
    const double distance = std::max(shortest_boundary_edge * m_typical_edge,
                                     (m_result.rest.back() - m_in.network.rest[s]).norm());
    m_edges.push_back({static_cast<std::uint32_t>(s),
                       node,
                       representable_weight(m_in.weight_unit * border / distance)});
    m_edges.push_back({node, static_cast<std::uint32_t>(s), m_edges.back().weight});
  }

  /// Adds a node for each border between regions of free samples.
  void add_nodes_in_free_regions()
  {
    for (std::size_t c = 0; c < m_crossings.size();) {
      const Border_crossing& key = m_crossings[c];
      double border = 0, nearest = std::numeric_limits<double>::infinity();
      std::uint32_t site = key.site;
      std::size_t end = c;
      for (; end < m_crossings.size() && m_crossings[end].beyond == key.beyond &&
             m_crossings[end].handle == key.handle && m_crossings[end].sample == key.sample;
           ++end) {
        border += m_crossings[end].length;
        const double d = squared_distance(m_crossings[end], key.sample);
        if (d < nearest) {
          nearest = d;
          site = m_crossings[end].site;
        }
      }
      if (is_free(key.sample) && is_free(key.beyond))
        add_node(key.sample, site, key.handle, border);
      c = end;
    }
  }

  /// Returns the site of handle `h` nearest to sample `outside` on the border in the region of
  /// sample `inside`, or `no_sample`.
  std::uint32_t nearest_crossing(std::uint32_t inside, Node_constraint h, std::size_t outside) const
  {
    auto crossing =
        std::lower_bound(m_crossings.begin(),
                         m_crossings.end(),
                         std::make_pair(inside, h),
                         [](const Border_crossing& a, const auto& key) {
                           return std::tie(a.beyond, a.handle) < std::tie(key.first, key.second);
                         });
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t site = no_sample;
    for (; crossing != m_crossings.end() && crossing->beyond == inside && crossing->handle == h;
         ++crossing) {
      const double d = squared_distance(*crossing, outside);
      if (d < nearest) {
        nearest = d;
        site = crossing->site;
      }
    }
    return site;
  }

  /// Adds the edges of the sample graph. An edge into a handle ends at the border of the handle if
  /// the border lies in the region of the sample inside.
  void add_edges()
  {
    const Weighted_graph& base = m_in.network.surface;
    for (std::size_t s = 0; s < m_in.network.size(); ++s)
      for (std::size_t e = base.first[s]; e < base.first[s + 1]; ++e)
        add_edge(s, base.neighbor[e], base.weight[e]);
  }

  void add_edge(std::size_t s, std::uint32_t t, double weight)
  {
    const bool leads_into_handle = is_free(s) && !is_free(t);
    const bool leads_out = !is_free(s) && is_free(t);
    std::uint32_t site = no_sample;
    const std::uint32_t inside = leads_out ? static_cast<std::uint32_t>(s) : t;
    const Node_constraint h = m_constraints.handle_of_node[inside];
    if (leads_into_handle || leads_out)
      site = nearest_crossing(inside, h, leads_out ? t : s);
    if (site == no_sample)
      m_edges.push_back({static_cast<std::uint32_t>(s), t, weight});
    else if (leads_into_handle)
      add_node(s,
               site,
               h,
               weight / m_in.weight_unit * (m_in.network.rest[t] - m_in.network.rest[s]).norm());
  }

  /// Stores the edges in rows, sorted by neighbour.
  void fill_rows()
  {
    Weighted_graph& surface = m_result.surface;
    const std::size_t n = m_result.rest.size();
    std::vector<Sample_edge> ordered;
    surface.first = pcs::internal::compress_rows<std::uint32_t>(
        n,
        m_edges.size(),
        [&](std::size_t k) { return std::size_t(m_edges[k].from); },
        [&](std::size_t count) { ordered.resize(count); },
        [&](std::size_t k, std::size_t position) { ordered[position] = m_edges[k]; });
    for (std::size_t i = 0; i < n; ++i)
      std::sort(ordered.begin() + static_cast<std::ptrdiff_t>(surface.first[i]),
                ordered.begin() + static_cast<std::ptrdiff_t>(surface.first[i + 1]),
                [](const Sample_edge& a, const Sample_edge& b) { return a.to < b.to; });
    for (const Sample_edge& e : ordered) {
      surface.neighbor.push_back(e.to);
      surface.weight.push_back(e.weight);
    }
    if (m_result.links.size() > 0)
      m_result.links.first.resize(n + 1, m_result.links.first.back());
  }

  const Input& m_in;
  Node_constraints& m_constraints;
  double m_typical_edge; ///< of the sample graph [L]
  Crossings m_crossings;
  std::vector<Sample_edge> m_edges;
  Elastic_network m_result;
};

} // namespace internal

/*!
  Returns the network with nodes added on the borders of exact handles, and extends `constraints` to
  these nodes.

  With few samples, the nearest sample in a handle lies well inside it, and the body would deform as
  if the handle ended at this sample. Therefore a boundary node is added at the point of the handle
  that is nearest to the free sample. It is prescribed like the handle, and its edge has the true
  distance. O(border edges).
*/
template <class HandleOfSite, class SitePosition>
Elastic_network add_boundary_nodes(const Boundary_input<HandleOfSite, SitePosition>& in,
                                   Node_constraints& constraints)
{
  return internal::Boundary_nodes<HandleOfSite, SitePosition>(in, constraints)();
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_ADD_BOUNDARY_NODES_H
