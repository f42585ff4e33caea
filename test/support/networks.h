// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Clouds in spatial order with their neighbour graph, as input for the stages of a deformation.

#ifndef PCS_TEST_SUPPORT_NETWORKS_H
#define PCS_TEST_SUPPORT_NETWORKS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Harmonic_system.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/spatial_order.h>
#include <support/point_clouds.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs_test {

/// Sorts a cloud spatially.
inline Points in_spatial_order(const Points& points)
{
  return permuted(points, pcs::neighborhood::spatial_order<CGAL::Sequential_tag>(points));
}

/// A cloud in spatial order with its weighted neighbour graph.
inline pcs::deformation::Elastic_network network_of(const Points& points, std::size_t k = 6)
{
  pcs::deformation::Elastic_network network;
  network.rest = in_spatial_order(points);
  static_cast<pcs::neighborhood::Proximity_graph&>(network.surface) =
      pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(network.rest, k);
  pcs::deformation::set_edge_weights<CGAL::Sequential_tag>(network.rest, network.surface);
  return network;
}

/// A chain of nodes with unit weights.
inline pcs::deformation::Weighted_graph path_graph(std::size_t n)
{
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    edges.emplace_back(i, i + 1);
  pcs::deformation::Weighted_graph graph;
  static_cast<pcs::neighborhood::Proximity_graph&>(graph) =
      pcs::neighborhood::graph_from_edges(n, edges);
  graph.weight.assign(graph.neighbor.size(), 1);
  return graph;
}

/// The factor of the harmonic system of a graph under constraints.
struct Harmonic
{
  pcs::deformation::Free_rows rows;
  pcs::linear_algebra::Sparse_cholesky factor;
  bool is_ok = false;

  Harmonic(const pcs::deformation::Weighted_graph& graph,
           const pcs::deformation::Node_constraints& constraints)
    : rows(constraints)
  {
    std::vector<double> soft(rows.size(), 0);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::size_t i = rows.node_of_row[r];
      if (constraints.is_soft(i))
        soft[r] =
            constraints.softness_weight[static_cast<std::size_t>(constraints.handle_of_node[i])] *
            pcs::deformation::node_degree(graph, i);
    }
    is_ok = factor.factorize(
        pcs::linear_algebra::free_laplacian<pcs::deformation::Weighted_graph>({&graph},
                                                                              rows.row_of_node,
                                                                              rows.node_of_row,
                                                                              soft));
  }
};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_NETWORKS_H
