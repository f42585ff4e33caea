// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Edges of the elastic energy of a registration: surface edges, bridges between components, and
// springs through the interior.

#ifndef PCS_REGISTRATION_ELASTIC_EDGES_H
#define PCS_REGISTRATION_ELASTIC_EDGES_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/neighborhood/Nearest_neighbors.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace pcs {
namespace registration {

struct Elastic_edge
{
  std::uint32_t i, j;
  double weight; ///< [-]
};

struct Elastic_edges
{
  std::vector<Elastic_edge> surface; ///< each edge once, `i < j`; bridges last
  std::vector<Elastic_edge> springs; ///< through the interior
};

/// Weight of an edge between two components, relative to a surface edge. It lets a component that
/// is not matched follow its neighbours. [-]
constexpr double bridge_weight = 0.05;
/// Number of bridges of a component. [count]
constexpr std::size_t bridges_of_component = 4;

/// Appends the shortest edges from each component to the others.
inline void add_bridges(const std::vector<deformation::Vec3>& rest,
                        const std::vector<std::uint32_t>& component,
                        std::vector<Elastic_edge>& edges)
{
  const std::uint32_t count =
      component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1;
  if (count < 2)
    return;
  const neighborhood::Nearest_neighbors tree(rest);
  std::vector<std::vector<std::tuple<double, std::uint32_t, std::uint32_t>>> found(count);
  for (std::uint32_t i = 0; i < rest.size(); ++i) {
    const auto nearest = tree.nearest_if(rest[i], 1e9, [&](std::uint32_t j) {
      return component[j] != component[i];
    });
    if (std::isfinite(nearest.squared_distance))
      found[component[i]].emplace_back(nearest.squared_distance,
                                       std::min(i, nearest.index),
                                       std::max(i, nearest.index));
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (auto& candidates : found) {
    std::sort(candidates.begin(), candidates.end());
    for (std::size_t k = 0; k < std::min(bridges_of_component, candidates.size()); ++k)
      pairs.emplace_back(std::get<1>(candidates[k]), std::get<2>(candidates[k]));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [i, j] : pairs)
    edges.push_back({i, j, bridge_weight});
}

/// Collects the edges of a network. \param component of each node
inline Elastic_edges collect_edges(const deformation::Elastic_network& network,
                                   const std::vector<std::uint32_t>& component)
{
  Elastic_edges result;
  const auto collect = [&](const deformation::Weighted_graph& graph,
                           std::vector<Elastic_edge>& edges) {
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
        if (graph.neighbor[e] > i)
          edges.push_back({static_cast<std::uint32_t>(i), graph.neighbor[e], graph.weight[e]});
  };
  collect(network.surface, result.surface);
  if (!network.links.neighbor.empty())
    collect(network.links, result.springs);
  add_bridges(network.rest, component, result.surface);
  return result;
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_ELASTIC_EDGES_H
