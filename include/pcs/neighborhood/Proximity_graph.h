// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Undirected neighbour graph of a point set in compressed rows, and its connected components.

#ifndef PCS_NEIGHBORHOOD_PROXIMITY_GRAPH_H
#define PCS_NEIGHBORHOOD_PROXIMITY_GRAPH_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace neighborhood {

/// Undirected graph over `[0, n)`: row `i` lists the neighbours of `i` in increasing order, each
/// edge twice.
struct Proximity_graph
{
  std::vector<std::uint32_t> first{0}; ///< n + 1 offsets into `neighbor`
  std::vector<std::uint32_t> neighbor;

  std::size_t size() const { return first.size() - 1; }
  std::size_t degree(std::size_t i) const { return first[i + 1] - first[i]; }
  const std::uint32_t* begin(std::size_t i) const { return neighbor.data() + first[i]; }
  const std::uint32_t* end(std::size_t i) const { return neighbor.data() + first[i + 1]; }
};

/// Builds rows from undirected pairs; duplicates and loops are dropped.
inline Proximity_graph graph_from_edges(std::size_t n,
                                        std::vector<std::pair<std::uint32_t, std::uint32_t>> edges)
{
  const std::size_t m = edges.size();
  edges.reserve(2 * m);
  for (std::size_t e = 0; e < m; ++e)
    edges.emplace_back(edges[e].second, edges[e].first);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Proximity_graph graph;
  graph.first.assign(n + 1, 0);
  for (const auto& e : edges)
    if (e.first != e.second) {
      ++graph.first[e.first + 1];
      graph.neighbor.push_back(e.second);
    }
  for (std::size_t i = 0; i < n; ++i)
    graph.first[i + 1] += graph.first[i];
  return graph;
}

/// Neighbours whose distance exceeds that of the k-th by no more than this factor belong to the row
/// as well: on a grid the k nearest are otherwise an arbitrary, lopsided choice among equals.
constexpr double distance_tie_factor = 1.01;
/// ... but no more than this many of them.
constexpr std::size_t maximal_number_of_ties = 4;
/// The largest `k`: one-directional links are marked in 64 bits.
constexpr std::size_t maximal_number_of_neighbors = 64 - maximal_number_of_ties;

/*!
  Links every point to its `k` nearest (ties included), then adds the missing reverse links.
  `points` must be distinct, `k <= maximal_number_of_neighbors`. Every row holds at least `min(k, n
  - 1)` neighbours. O(n log n + n k).
*/
template <class ConcurrencyTag>
Proximity_graph nearest_neighbor_graph(const std::vector<Vec3>& points, std::size_t k)
{
  const std::size_t n = points.size();
  const std::size_t width = std::min(k + maximal_number_of_ties, n > 0 ? n - 1 : 0);
  std::vector<std::uint32_t> list(n * width);
  std::vector<std::uint8_t> length(n, 0);
  {
    const Nearest_neighbors nearest(points);
    pcs::internal::for_each_block<ConcurrencyTag>(n, 512, [&](std::size_t begin, std::size_t end) {
      std::vector<Nearest_neighbors::Neighbor> found;
      for (std::size_t i = begin; i < end; ++i) {
        nearest(points[i], width + 1, found);
        found.erase(
            std::remove_if(found.begin(), found.end(), [i](const auto& f) { return f.index == i; }),
            found.end());
        std::size_t count = std::min(k, found.size());
        if (count > 0) {
          const double tie =
              distance_tie_factor * distance_tie_factor * found[count - 1].squared_distance;
          while (count < std::min(width, found.size()) && found[count].squared_distance <= tie)
            ++count;
        }
        for (std::size_t b = 0; b < count; ++b)
          list[i * width + b] = found[b].index;
        length[i] = static_cast<std::uint8_t>(count);
      }
    });
  }
  const auto holds = [&](std::size_t i, std::size_t j) {
    const auto* row = list.data() + i * width;
    return std::find(row, row + length[i], static_cast<std::uint32_t>(j)) != row + length[i];
  };
  // One-directional links, by source, marked in parallel and added in order.
  std::vector<std::uint64_t> is_missing(n, 0); // bit b: the b-th neighbour lacks the link back
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    for (std::size_t b = 0; b < length[i]; ++b)
      if (!holds(list[i * width + b], i))
        is_missing[i] |= std::uint64_t(1) << b;
  });
  Proximity_graph graph;
  graph.first.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    graph.first[i + 1] += length[i];
    for (std::size_t b = 0; b < length[i]; ++b)
      if (is_missing[i] >> b & 1)
        ++graph.first[list[i * width + b] + 1];
  }
  for (std::size_t i = 0; i < n; ++i)
    graph.first[i + 1] += graph.first[i];
  graph.neighbor.resize(graph.first[n]);
  std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t b = 0; b < length[i]; ++b) {
      const std::uint32_t j = list[i * width + b];
      graph.neighbor[next[i]++] = j;
      if (is_missing[i] >> b & 1)
        graph.neighbor[next[j]++] = static_cast<std::uint32_t>(i);
    }
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    std::sort(graph.neighbor.begin() + graph.first[i], graph.neighbor.begin() + graph.first[i + 1]);
  });
  return graph;
}

/// Component of every vertex, numbered by their smallest vertex; `count` receives the number of
/// components.
inline std::vector<std::uint32_t> connected_components(const Proximity_graph& graph,
                                                       std::size_t& count)
{
  constexpr std::uint32_t unseen = ~std::uint32_t(0);
  std::vector<std::uint32_t> component(graph.size(), unseen), stack;
  count = 0;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (component[i] != unseen)
      continue;
    const auto c = static_cast<std::uint32_t>(count++);
    component[i] = c;
    stack.push_back(static_cast<std::uint32_t>(i));
    while (!stack.empty()) {
      const std::uint32_t v = stack.back();
      stack.pop_back();
      for (auto j = graph.begin(v); j != graph.end(v); ++j)
        if (component[*j] == unseen) {
          component[*j] = c;
          stack.push_back(*j);
        }
    }
  }
  return component;
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_PROXIMITY_GRAPH_H
