// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Undirected neighbour graph of a point set in compressed rows, and its connected components.

#ifndef PCS_NEIGHBORHOOD_PROXIMITY_GRAPH_H
#define PCS_NEIGHBORHOOD_PROXIMITY_GRAPH_H

#include <pcs/internal/compress_rows.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Neighbor_lists.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace neighborhood {

/// An undirected graph over `[0, n)`: row `i` lists the neighbours of `i` in increasing order, so
/// each edge is stored twice.
struct Proximity_graph
{
  std::vector<std::uint32_t> first{0}; ///< n + 1 offsets into `neighbor`
  std::vector<std::uint32_t> neighbor;

  std::size_t size() const { return first.size() - 1; }
  std::size_t degree(std::size_t i) const { return first[i + 1] - first[i]; }
  const std::uint32_t* begin(std::size_t i) const { return neighbor.data() + first[i]; }
  const std::uint32_t* end(std::size_t i) const { return neighbor.data() + first[i + 1]; }
};

/// Builds the rows from undirected pairs; removes duplicates and loops.
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
  graph.first = pcs::internal::compress_rows<std::uint32_t>(
      n,
      edges.size(),
      [&](std::size_t e) { return edges[e].first != edges[e].second ? edges[e].first : n; },
      [&](std::size_t count) { graph.neighbor.resize(count); },
      [&](std::size_t e, std::size_t at) { graph.neighbor[at] = edges[e].second; });
  return graph;
}

namespace internal {

/// Returns the links in only one direction: bit `b` of a point is set if its `b`-th neighbour lacks
/// the reverse link. Computed in parallel.
template <class ConcurrencyTag>
std::vector<std::uint64_t> mark_missing_links(const Neighbor_lists& lists)
{
  std::vector<std::uint64_t> is_missing(lists.length.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(lists.length.size(), [&](std::size_t i) {
    for (std::size_t b = 0; b < lists.length[i]; ++b)
      if (!lists.holds(lists.at(i, b), i))
        is_missing[i] |= std::uint64_t(1) << b;
  });
  return is_missing;
}

/// Returns the missing reverse links, in rows of the points that lack them.
template <class ConcurrencyTag>
Proximity_graph find_missing_links(const Neighbor_lists& lists)
{
  const std::vector<std::uint64_t> is_missing = mark_missing_links<ConcurrencyTag>(lists);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links; // from a neighbour back to its point
  for (std::size_t i = 0; i < is_missing.size(); ++i)
    for (std::size_t b = 0; is_missing[i] != 0 && b < lists.length[i]; ++b)
      if (is_missing[i] >> b & 1)
        links.emplace_back(lists.at(i, b), static_cast<std::uint32_t>(i));
  Proximity_graph graph;
  graph.first = pcs::internal::compress_rows<std::uint32_t>(
      is_missing.size(),
      links.size(),
      [&](std::size_t e) { return links[e].first; },
      [&](std::size_t count) { graph.neighbor.resize(count); },
      [&](std::size_t e, std::size_t at) { graph.neighbor[at] = links[e].second; });
  return graph;
}

} // namespace internal

/*!
  Links every point to its `k` nearest neighbours (ties included), then adds the missing reverse
  links. `points` must be distinct, `k <= maximal_number_of_neighbors`. Every row has at least
  `min(k, n - 1)` neighbours. O(n log n + n k).
*/
template <class ConcurrencyTag>
Proximity_graph nearest_neighbor_graph(const std::vector<Vec3>& points, std::size_t k)
{
  const std::size_t n = points.size();
  const internal::Neighbor_lists lists = internal::find_neighbor_lists<ConcurrencyTag>(points, k);
  const Proximity_graph missing = internal::find_missing_links<ConcurrencyTag>(lists);
  Proximity_graph graph;
  graph.first.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    graph.first[i + 1] =
        graph.first[i] + lists.length[i] + static_cast<std::uint32_t>(missing.degree(i));
  graph.neighbor.resize(graph.first[n]);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    const auto row = graph.neighbor.begin() + graph.first[i];
    const auto own = lists.neighbor.begin() + static_cast<std::ptrdiff_t>(i * lists.width);
    const auto end =
        std::copy(missing.begin(i), missing.end(i), std::copy_n(own, lists.length[i], row));
    std::sort(row, end);
  });
  return graph;
}

namespace internal {

/// Disjoint sets of vertices. The root of a set is its smallest vertex.
class Vertex_sets
{
public:
  template <class ConcurrencyTag>
  static Vertex_sets of_singles(std::size_t n)
  {
    Vertex_sets sets;
    sets.m_parent.resize(n);
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
      sets.m_parent[i] = static_cast<std::uint32_t>(i);
    });
    return sets;
  }

  std::uint32_t root(std::uint32_t i)
  {
    while (m_parent[i] != i)
      i = m_parent[i] = m_parent[m_parent[i]];
    return i;
  }

  void join(std::uint32_t i, std::uint32_t j)
  {
    i = root(i);
    j = root(j);
    m_parent[std::max(i, j)] = std::min(i, j);
  }

  std::uint32_t parent(std::size_t i) const { return m_parent[i]; }

private:
  std::vector<std::uint32_t> m_parent;
};

} // namespace internal

/// Returns the component of every vertex; components are numbered by their smallest vertex. `count`
/// receives their number. Blocks of consecutive vertices are searched concurrently.
template <class ConcurrencyTag = CGAL::Sequential_tag>
std::vector<std::uint32_t> connected_components(const Proximity_graph& graph, std::size_t& count)
{
  constexpr std::size_t block_size = 16384;
  const std::size_t n = graph.size(), number_of_blocks = (n + block_size - 1) / block_size;
  auto sets = internal::Vertex_sets::of_singles<ConcurrencyTag>(n);
  std::vector<std::vector<std::uint32_t>> crossing(number_of_blocks); // vertices with other edges
  pcs::internal::for_each_block<ConcurrencyTag>(
      n,
      block_size,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          bool is_crossing = false;
          for (auto j = graph.begin(i); j != graph.end(i) && *j < i; ++j)
            if (*j >= begin)
              sets.join(static_cast<std::uint32_t>(i), *j);
            else
              is_crossing = true;
          if (is_crossing)
            crossing[begin / block_size].push_back(static_cast<std::uint32_t>(i));
        }
      });
  for (std::size_t b = 0; b < number_of_blocks; ++b)
    for (const std::uint32_t i : crossing[b])
      for (auto j = graph.begin(i); j != graph.end(i) && *j < b * block_size; ++j)
        sets.join(i, *j);
  count = 0;
  std::vector<std::uint32_t> component(n);
  for (std::size_t i = 0; i < n; ++i) { // a parent has a smaller number
    const std::uint32_t parent = sets.parent(i);
    component[i] = parent == i ? static_cast<std::uint32_t>(count++) : component[parent];
  }
  return component;
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_PROXIMITY_GRAPH_H
