// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Cotangent weights of point sets from Voronoi cells in tangent planes.

#ifndef PCS_DEFORMATION_BODY_VORONOI_GRAPH_H
#define PCS_DEFORMATION_BODY_VORONOI_GRAPH_H

#include <pcs/deformation/body/Voronoi_stars.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <boost/pending/disjoint_sets.hpp>
#include <boost/property_map/property_map.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// Fraction of the proximity weights that is used where no cell can be cut. [-]
constexpr double proximity_share = 0.05;
/// Sides that weigh less than this in total do not hold a point: it lies on a wire, at a corner, or
/// is an outlier. [-]
constexpr double least_star = 1.5;
/// Lighter edges do not hold two parts together. [-]
constexpr double least_link = 0.02;
/// Clouds with edges that are lighter still are no sampled surface, but points at ever smaller
/// distances; their factors need all edges there are. [-]
constexpr double least_surface_weight = 1e-14;
/// Weights of the edges at a point, on average. [-]
constexpr double mean_degree = 6.5;

namespace internal {

/// Half-edges of the neighbour graph with weights from the Voronoi cells of both ends.
struct Star_edges
{
  std::vector<double> weight;   ///< by half-edge [-]
  std::vector<double> weakness; ///< of points: 0 with enough sides, up to 1 without any [-]
};

template <class ConcurrencyTag>
Star_edges weigh_star_edges(const Voronoi_stars& stars,
                            const neighborhood::Proximity_graph& neighbors)
{
  const auto half_weight = [&](std::size_t i, std::uint32_t j) {
    double weight = 0;
    for (std::size_t e = stars.first[i]; e < stars.first[i + 1]; ++e)
      if (stars.side[e].neighbor == j)
        weight += 0.5 * static_cast<double>(stars.side[e].weight);
    return weight;
  };
  const std::size_t n = stars.size();
  Star_edges edges;
  edges.weight.resize(neighbors.neighbor.size());
  edges.weakness.resize(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    double sum = 0;
    for (std::size_t e = neighbors.first[i]; e < neighbors.first[i + 1]; ++e) {
      const auto k = static_cast<std::uint32_t>(i);
      const std::uint32_t j = neighbors.neighbor[e];
      edges.weight[e] =
          half_weight(std::min(j, k), std::max(j, k)) +
          half_weight(std::max(j, k), std::min(j, k)); // the same bits for both half-edges
      sum += edges.weight[e];
    }
    edges.weakness[i] = std::max(0.0, 1 - sum / least_star);
  });
  return edges;
}

/// Fraction of the weight of a proximity edge that is added where the cells of its ends are weak.
inline double proximity_fraction(const Star_edges& edges, std::uint32_t i, std::uint32_t j)
{
  return 0.5 * proximity_share * (edges.weakness[i] + edges.weakness[j]);
}

/// Half-edges of the proximity graph, sorted.
using Bridges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The heaviest proximity edges without which components would fall apart; weak edges do not
/// connect.
inline Bridges find_bridges(const Star_edges& edges,
                            const neighborhood::Proximity_graph& neighbors,
                            const Weighted_graph& proximity)
{
  using Index_map = boost::typed_identity_property_map<std::uint32_t>;
  const auto n = static_cast<std::uint32_t>(edges.weakness.size());
  std::vector<std::uint32_t> rank(n, 0), parent(n);
  std::iota(parent.begin(), parent.end(), std::uint32_t(0));
  boost::disjoint_sets parts(boost::make_iterator_property_map(rank.begin(), Index_map()),
                             boost::make_iterator_property_map(parent.begin(), Index_map()));
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::size_t e = neighbors.first[i]; e < neighbors.first[i + 1]; ++e)
      if (edges.weight[e] > least_link)
        parts.union_set(i, neighbors.neighbor[e]);
    for (std::size_t e = proximity.first[i]; e < proximity.first[i + 1]; ++e)
      if (proximity_fraction(edges, i, proximity.neighbor[e]) * proximity.weight[e] > least_link)
        parts.union_set(i, proximity.neighbor[e]);
  }
  using Bridge = std::tuple<double, std::uint32_t, std::uint32_t>; // negative weight, from, to
  std::vector<Bridge> candidates;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::size_t e = proximity.first[i]; e < proximity.first[i + 1]; ++e)
      if (i < proximity.neighbor[e] && parts.find_set(i) != parts.find_set(proximity.neighbor[e]))
        candidates.emplace_back(-proximity.weight[e], i, proximity.neighbor[e]);
  std::sort(candidates.begin(), candidates.end());
  Bridges bridges;
  for (const auto& [weight, from, to] : candidates)
    if (parts.find_set(from) != parts.find_set(to)) {
      parts.union_set(from, to);
      bridges.emplace_back(from, to);
      bridges.emplace_back(to, from);
    }
  std::sort(bridges.begin(), bridges.end());
  return bridges;
}

/// Rows of a block of points.
struct Star_rows
{
  std::vector<std::uint32_t> neighbor;
  std::vector<double> weight;

  /// Appends a row; adds up entries of the same neighbour. Returns the number of neighbours.
  std::uint32_t append(std::vector<std::pair<std::uint32_t, double>>& row)
  {
    std::sort(row.begin(), row.end());
    const std::size_t before = neighbor.size();
    for (const auto& [j, w] : row)
      if (neighbor.size() > before && neighbor.back() == j)
        weight.back() += w;
      else {
        neighbor.push_back(j);
        weight.push_back(w);
      }
    for (std::size_t e = before; e < weight.size(); ++e)
      weight[e] = representable_weight(weight[e]);
    return static_cast<std::uint32_t>(neighbor.size() - before);
  }
};

/// The weight of an edge is half the sum of those of the two cells. Proximity edges are added where
/// the stars are weak, and where components would fall apart.
template <class ConcurrencyTag>
Weighted_graph star_graph(const Voronoi_stars& stars,
                          const neighborhood::Proximity_graph& neighbors,
                          const Weighted_graph& proximity)
{
  const std::size_t n = stars.size();
  const Star_edges edges = weigh_star_edges<ConcurrencyTag>(stars, neighbors);
  const Bridges bridges = find_bridges(edges, neighbors, proximity);
  const auto added_weight = [&](std::uint32_t i, std::size_t e) { // of a proximity edge
    const std::uint32_t j = proximity.neighbor[e];
    const bool is_bridge = !bridges.empty() &&
                           std::binary_search(bridges.begin(), bridges.end(), std::make_pair(i, j));
    return (is_bridge ? 1 : proximity_fraction(edges, std::min(j, i), std::max(j, i))) *
           proximity.weight[e];
  };
  Weighted_graph graph;
  graph.first.resize(n + 1);
  constexpr std::size_t block_size = 512;
  std::vector<Star_rows> blocks((n + block_size - 1) / block_size);
  pcs::internal::for_each_block<ConcurrencyTag>(
      n,
      block_size,
      [&](std::size_t begin, std::size_t end) {
        std::vector<std::pair<std::uint32_t, double>> row;
        for (std::size_t i = begin; i < end; ++i) {
          row.clear();
          for (std::size_t e = neighbors.first[i]; e < neighbors.first[i + 1]; ++e)
            row.emplace_back(neighbors.neighbor[e], edges.weight[e]);
          for (std::size_t e = proximity.first[i]; e < proximity.first[i + 1]; ++e)
            if (const double added = added_weight(static_cast<std::uint32_t>(i), e); added > 0)
              row.emplace_back(proximity.neighbor[e], added);
          graph.first[i + 1] = blocks[begin / block_size].append(row);
        }
      });
  for (std::size_t i = 0; i < n; ++i)
    graph.first[i + 1] += graph.first[i];
  graph.neighbor.reserve(graph.first.back());
  graph.weight.reserve(graph.first.back());
  for (const Star_rows& rows : blocks) {
    graph.neighbor.insert(graph.neighbor.end(), rows.neighbor.begin(), rows.neighbor.end());
    graph.weight.insert(graph.weight.end(), rows.weight.begin(), rows.weight.end());
  }
  return graph;
}

} // namespace internal

/*!
  The graph of the points whose Voronoi cells touch along the surface, weighted by the length of the
  common side over the distance: the cotangent Laplacian of a Delaunay triangulation, without one.

  On a plane, linear functions are harmonic for these weights, however irregular the points; for
  those of `set_edge_weights()` they are only on average. Every cell is cut in the tangent plane of
  its point, by the neighbours of neighbours; large or open cells are cut again by those of the
  cells around them. Where no cell can be cut (wires, outliers), a fraction of the proximity weights
  is used. For clouds without a typical spacing, the proximity graph is returned unchanged.

  \param proximity weighted by `set_edge_weights()`; the result has the same components
  \param go_on asked after parts of the work; if it returns `false`, the result is `proximity`

  O(n) for bounded degrees.
*/
template <class ConcurrencyTag>
Weighted_graph voronoi_graph(const std::vector<Vec3>& points,
                             const Weighted_graph& proximity,
                             const pcs::internal::Go_on& go_on = {})
{
  using internal::Voronoi_stars;
  const std::size_t n = points.size();
  constexpr int number_of_passes = 5;
  if (std::any_of(proximity.weight.begin(), proximity.weight.end(), [](double w) {
        return w < least_surface_weight;
      }))
    return proximity;
  const std::vector<internal::Tangent_plane> planes =
      internal::tangent_planes<ConcurrencyTag>(points, proximity);
  Voronoi_stars stars = internal::voronoi_stars<ConcurrencyTag>(
      points,
      planes,
      internal::Proximity_neighbors{proximity},
      {},
      [](std::size_t) { return true; },
      pcs::internal::part_of(go_on, 0, 0.6));
  for (int pass = 1; pass < number_of_passes; ++pass) {
    const double done = 0.6 + 0.06 * pass;
    if (!pcs::internal::goes_on(go_on, done))
      return proximity;
    const internal::Star_neighbors neighbors(stars, ConcurrencyTag());
    const auto is_made = [&](std::size_t i) {
      bool is_changed = stars.is_changed[i] != 0;
      neighbors.for_each_neighbor(i, [&](std::uint32_t j) {
        is_changed = is_changed || stars.is_changed[j] != 0;
      });
      return is_changed && neighbors.is_doubtful[i] != 0;
    };
    stars =
        internal::voronoi_stars<ConcurrencyTag>(points,
                                                planes,
                                                neighbors,
                                                stars,
                                                is_made,
                                                pcs::internal::part_of(go_on, done, done + 0.06));
  }
  if (!pcs::internal::goes_on(go_on, 0.9))
    return proximity;
  const internal::Star_neighbors neighbors(stars, ConcurrencyTag());
  Weighted_graph graph = internal::star_graph<ConcurrencyTag>(stars, neighbors.graph, proximity);
  const double sum = pcs::internal::blocked_reduce<ConcurrencyTag>(
      graph.weight.size(),
      0.0,
      [&](std::size_t e) { return graph.weight[e]; },
      std::plus<double>());
  const double scale = sum > 0 ? mean_degree * static_cast<double>(n) / sum : 1;
  for (double& w : graph.weight)
    w *= scale;
  return graph;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_VORONOI_GRAPH_H
