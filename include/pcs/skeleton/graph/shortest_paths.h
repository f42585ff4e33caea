// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shortest paths on the neighbour graph from several sources.

#ifndef PCS_SKELETON_GRAPH_SHORTEST_PATHS_H
#define PCS_SKELETON_GRAPH_SHORTEST_PATHS_H

#include <pcs/internal/lanes.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Shortest paths from a set of sources; unreached points have an infinite distance and are their
/// own predecessor.
struct Shortest_paths
{
  std::vector<double> distance;
  std::vector<Index> predecessor;
};

namespace internal {

/*!
  Priority queue of points in buckets by distance: a ring of buckets, and a list of entries beyond
  it. Entries of a bucket have no order, so that the next points are known and can be prefetched.
*/
class Distance_buckets
{
public:
  struct Entry
  {
    double distance;
    Index point;
  };

  explicit Distance_buckets(double width) : m_scale(1 / width), m_ring(number_of_buckets) {}

  void push(double distance, Index point)
  {
    const auto bucket = static_cast<std::uint64_t>(distance * m_scale);
    if (bucket < m_now + number_of_buckets) {
      m_ring[bucket % number_of_buckets].push_back({distance, point});
      ++m_size;
    } else
      m_beyond.push_back({distance, point});
  }

  /// Moves the nearest bucket to `entries`; entries pushed later may be nearer than some of these.
  /// Returns `false` if the queue is empty.
  bool pop(std::vector<Entry>& entries)
  {
    entries.clear();
    while (m_size > 0 || !m_beyond.empty()) {
      auto& bucket = m_ring[m_now % number_of_buckets];
      if (!bucket.empty()) {
        entries.swap(bucket);
        m_size -= entries.size();
        return true;
      }
      // entries beyond the ring are at least one cycle away
      if (++m_now % number_of_buckets == 0 || m_size == 0)
        bring_in();
    }
    return false;
  }

private:
  static constexpr std::uint64_t number_of_buckets = 128;

  /// Distributes the entries beyond the ring. An empty ring restarts at the nearest entry.
  void bring_in()
  {
    std::vector<Entry> beyond;
    beyond.swap(m_beyond);
    if (m_size == 0 && !beyond.empty()) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Entry& e : beyond)
        nearest = std::min(nearest, e.distance);
      m_now = static_cast<std::uint64_t>(nearest * m_scale);
    }
    for (const Entry& e : beyond)
      push(e.distance, e.point);
  }

  double m_scale;
  std::vector<std::vector<Entry>> m_ring;
  std::vector<Entry> m_beyond;
  std::uint64_t m_now = 0; ///< the nearest bucket
  std::size_t m_size = 0;  ///< of the ring
};

} // namespace internal

/// Width of the buckets in spacings [-].
constexpr double path_bucket = 1;

/*!
  Computes shortest paths with a bucket queue instead of a heap. A point is processed again if a
  shorter path to it is found later; in return, no order within buckets is maintained, and
  neighbours are prefetched. The distances are bitwise identical to
  `boost::dijkstra_shortest_paths()`: both are the least of the sums over neighbours. Of
  predecessors with equal sums, the first is kept. O(edges), except for repeated points.
*/
inline Shortest_paths
shortest_paths(const Scan& scan, const Neighbor_graph& graph, const std::vector<Index>& sources)
{
  constexpr std::size_t ahead = 2, far_ahead = 5; // in points
  const std::size_t n = scan.size();
  Shortest_paths paths;
  paths.distance.assign(n, std::numeric_limits<double>::infinity());
  paths.predecessor.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    paths.predecessor[i] = static_cast<Index>(i);
  std::vector<double>& distance = paths.distance;
  internal::Distance_buckets waiting(path_bucket * scan.spacing);
  for (const Index s : sources) {
    distance[s] = 0;
    waiting.push(0, s);
  }
  const auto fetch = [](const auto& element) {
    pcs::internal::prefetch(&element, sizeof(element));
  };
  std::vector<internal::Distance_buckets::Entry> now;
  while (waiting.pop(now))
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (k + far_ahead < now.size()) {
        const Index v = now[k + far_ahead].point;
        fetch(distance[v]);
        if (graph.begin(v) != graph.end(v))
          fetch(*graph.begin(v));
      }
      if (k + ahead < now.size() && !(now[k + ahead].distance > distance[now[k + ahead].point])) {
        const Index v = now[k + ahead].point;
        for (const Index* w = graph.begin(v); w != graph.end(v); ++w) {
          fetch(distance[*w]);
          fetch(scan.points[*w]);
        }
      }
      const Index v = now[k].point;
      const double before = now[k].distance;
      if (before > distance[v])
        continue; // outdated: a shorter path was found
      for (const Index* w = graph.begin(v); w != graph.end(v); ++w) {
        const Index to = *w;
        if (distance[to] <= before)
          continue;
        const double d = before + step_cost(scan, v, to);
        if (!(d < distance[to]))
          continue;
        distance[to] = d;
        paths.predecessor[to] = v;
        waiting.push(d, to);
      }
    }
  return paths;
}

/// Returns all points, each before its predecessor. O(points).
inline std::vector<Index> tips_first(const Shortest_paths& paths)
{
  const std::size_t n = paths.predecessor.size();
  std::vector<Index> children(n, 0), order;
  for (std::size_t i = 0; i < n; ++i)
    if (paths.predecessor[i] != i)
      ++children[paths.predecessor[i]];
  order.reserve(n);
  for (Index i = 0; i < n; ++i)
    if (children[i] == 0)
      order.push_back(i);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Index next = paths.predecessor[order[k]];
    if (next != order[k] && --children[next] == 0)
      order.push_back(next);
  }
  return order;
}

/// Returns the number of paths through each point, including its own, for points in the order of
/// `tips_first()` [count]. O(points).
inline std::vector<double> carried_paths(const Shortest_paths& paths,
                                         const std::vector<Index>& order)
{
  std::vector<double> carried(paths.predecessor.size(), 1);
  for (const Index i : order)
    if (paths.predecessor[i] != i)
      carried[paths.predecessor[i]] += carried[i];
  return carried;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_GRAPH_SHORTEST_PATHS_H
