// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Straight borders of handles on irregular samplings.

#ifndef PCS_DEFORMATION_HANDLES_STRAIGHTEN_BORDERS_H
#define PCS_DEFORMATION_HANDLES_STRAIGHTEN_BORDERS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

/// Distance and direction in which a handle extends beyond one of its nodes.
struct Border_advance
{
  Vec3 direction = Vec3::Zero(); ///< unit vector that points out of the handle
  double distance = 0;           ///< [L]
};

/// Handle nodes whose lateral distance exceeds this do not affect the border at a node. [spacings]
constexpr double widest_border_patch = 2;
/// The border leaves at least this fraction of an edge to the free node. [-]
constexpr double least_free_share = 0.2;
/// Borders nearer to their node than this are not moved. [fractions of the edge]
constexpr double negligible_advance = 1e-6;

/// Returns the distance of the border from node `j`. The border is the line through the outermost
/// nodes of the handle around `j`.
inline Border_advance
border_advance(const Elastic_network& network, const Node_constraints& constraints, std::size_t j)
{
  const Weighted_graph& graph = network.surface;
  const auto for_each_near = [&](const auto& use) {
    for (auto a = graph.begin(j); a != graph.end(j); ++a) {
      use(*a);
      for (auto b = graph.begin(*a); b != graph.end(*a); ++b)
        if (*b != j)
          use(*b);
    }
  };
  const Node_constraint handle = constraints.handle_of_node[j];
  const double reach = widest_border_patch * local_spacing(network.rest, graph, j);
  Vec3 inside = Vec3::Zero(), outside = Vec3::Zero();
  double number_inside = 1, number_outside = 0;
  for_each_near([&](std::uint32_t k) {
    const Vec3 offset = network.rest[k] - network.rest[j];
    if (constraints.handle_of_node[k] == handle) {
      inside += offset;
      number_inside += 1;
    } else if (!constraints.is_prescribed(k)) {
      outside += offset;
      number_outside += 1;
    }
  });
  Border_advance result;
  if (number_outside == 0)
    return result;
  const Vec3 out = outside / number_outside - inside / number_inside;
  const double length = out.norm();
  if (!(length > 0))
    return result;
  result.direction = out / length;
  for_each_near([&](std::uint32_t k) {
    if (constraints.handle_of_node[k] != handle)
      return;
    const Vec3 offset = network.rest[k] - network.rest[j];
    const double ahead = offset.dot(result.direction);
    if ((offset - ahead * result.direction).squaredNorm() <= reach * reach)
      result.distance = std::max(result.distance, ahead);
  });
  return result;
}

} // namespace internal

namespace internal {

/// An edge from a free node to a handle that is cut at the border.
struct Held_edge
{
  std::size_t free, held; ///< indices of the two half-edges
  std::uint32_t node, handle_node;
  double fraction; ///< fraction of the edge that lies inside the handle [-]
};

/// Finds the edges that cross a border, sorted by the node of the handle.
inline std::vector<Held_edge> find_held_edges(const Elastic_network& network,
                                              const Node_constraints& constraints)
{
  const Weighted_graph& graph = network.surface;
  std::vector<Held_edge> edges;
  for (std::uint32_t j = 0; j < network.size(); ++j) {
    if (!constraints.is_prescribed(j))
      continue;
    Border_advance advance;
    bool is_known = false;
    for (std::size_t e = graph.first[j]; e < graph.first[j + 1]; ++e) {
      const std::uint32_t i = graph.neighbor[e];
      if (constraints.is_prescribed(i) || constraints.handle_of_node[i] == unreached_node)
        continue;
      if (!is_known)
        advance = border_advance(network, constraints, j);
      is_known = true;
      const double ahead = (network.rest[i] - network.rest[j]).dot(advance.direction);
      if (!(ahead > 0) || !(advance.distance > negligible_advance * ahead))
        continue;
      const double fraction = std::min(1 - least_free_share, advance.distance / ahead);
      const auto back = std::lower_bound(graph.begin(i), graph.end(i), j);
      edges.push_back({static_cast<std::size_t>(back - graph.neighbor.data()), e, i, j, fraction});
    }
  }
  return edges;
}

/// Returns the network in which the edges of the free nodes lead to new nodes on the border. The
/// half-edges from the handles are removed. `edges` are sorted by `free`.
inline Elastic_network cut_held_edges(const Elastic_network& network,
                                      const std::vector<Held_edge>& edges,
                                      Node_constraints& constraints)
{
  const Weighted_graph& graph = network.surface;
  std::vector<char> is_dropped(graph.neighbor.size(), 0);
  for (const Held_edge& b : edges)
    is_dropped[b.free] = is_dropped[b.held] = 1;
  Elastic_network result;
  result.rest.reserve(network.size() + edges.size());
  result.rest = network.rest;
  result.links = network.links;
  result.area = network.area;
  result.surface_rank = network.surface_rank;
  result.rank = network.rank;
  Weighted_graph& surface = result.surface;
  surface.first.reserve(network.size() + edges.size() + 1);
  surface.neighbor.reserve(graph.neighbor.size());
  surface.weight.reserve(graph.neighbor.size());
  const auto add = [&](std::uint32_t neighbor, double weight) {
    surface.neighbor.push_back(neighbor);
    surface.weight.push_back(weight);
  };
  const auto end_row = [&] {
    surface.first.push_back(static_cast<std::uint32_t>(surface.neighbor.size()));
  };
  const auto new_weight = [&](const Held_edge& b) {
    return representable_weight(graph.weight[b.free] / (1 - b.fraction));
  };
  auto next = edges.begin();
  for (std::size_t i = 0; i < network.size(); ++i) {
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      if (!is_dropped[e])
        add(graph.neighbor[e], graph.weight[e]);
    for (; next != edges.end() && next->node == i; ++next) {
      add(static_cast<std::uint32_t>(result.rest.size()), new_weight(*next));
      const Vec3& held = network.rest[next->handle_node];
      result.rest.push_back(held + next->fraction * (network.rest[i] - held));
      result.source.push_back(next->handle_node);
      constraints.handle_of_node.push_back(constraints.handle_of_node[next->handle_node]);
    }
    end_row();
  }
  for (const Held_edge& b : edges) {
    add(b.node, new_weight(b));
    end_row();
  }
  if (result.links.size() > 0)
    result.links.first.resize(result.rest.size() + 1, result.links.first.back());
  return result;
}

} // namespace internal

/*!
  Gives the edges between free nodes and exact handles their true length up to the border of the
  handle.

  If points are selected by a region of space, the outermost ones lie on average half a spacing
  inside its border. If only these points were held, the body would deform as if the handle were
  half a spacing shorter. Here the border leads through the outermost points of the handle around
  each point (on a grid: through all of them). Where it crosses an edge at the fraction `t` of its
  length, `result` gets an additional node that moves with the handle. The weight of the new edge is
  the weight of the old edge divided by `1 - t`. Constraints are extended to the new nodes.

  Returns `false`, with `result` unchanged, if no border extends beyond its nodes. O(n).
*/
inline bool straighten_borders(const Elastic_network& network,
                               Node_constraints& constraints,
                               Elastic_network& result)
{
  std::vector<internal::Held_edge> edges = internal::find_held_edges(network, constraints);
  if (edges.empty())
    return false;
  std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
    return a.free < b.free;
  });
  result = internal::cut_held_edges(network, edges, constraints);
  return true;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_STRAIGHTEN_BORDERS_H
