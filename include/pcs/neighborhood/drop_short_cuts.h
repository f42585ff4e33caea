// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removes links of a neighbour graph that jump from one sheet of a surface to another.

#ifndef PCS_NEIGHBORHOOD_DROP_SHORT_CUTS_H
#define PCS_NEIGHBORHOOD_DROP_SHORT_CUTS_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/surface_normals.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace neighborhood {

/// A link is a short-cut candidate if the sine of its angle to the tangent planes at both ends is
/// at least this value. On sheets 1.5 spacings apart with jitter up to 0.3 spacings, the value 0.5
/// removes all 2,720 links between sheets, and 0.45 and 0.6 do not. Bars and scans lose at most
/// 0.2 % of their links. [-]
constexpr double smallest_short_cut_sine = 0.5;
/// Candidate links of a point are kept if it has fewer other links than this, because such a point
/// is an outlier. [count]
constexpr std::size_t smallest_remaining_degree = 2;
/// A component of at most this many points that is separated by removed links is a group of
/// outliers, not a sheet. Its shortest removed link is restored. [count]
constexpr std::size_t largest_clump = 12;

namespace internal {

/// Disjoint sets of points with their sizes.
class Point_sets
{
public:
  explicit Point_sets(std::size_t n) : m_parent(n), m_size(n, 1)
  {
    for (std::size_t i = 0; i < n; ++i)
      m_parent[i] = static_cast<std::uint32_t>(i);
  }

  std::uint32_t find(std::uint32_t i)
  {
    while (m_parent[i] != i)
      i = m_parent[i] = m_parent[m_parent[i]];
    return i;
  }

  std::uint32_t size(std::uint32_t i) { return m_size[find(i)]; }

  void join(std::uint32_t i, std::uint32_t j)
  {
    i = find(i);
    j = find(j);
    if (i == j)
      return;
    if (m_size[i] < m_size[j])
      std::swap(i, j);
    m_parent[j] = i;
    m_size[i] += m_size[j];
  }

private:
  std::vector<std::uint32_t> m_parent, m_size;
};

/// Restores the shortest removed links that would separate `largest_clump` points or fewer.
/// \param suspects the points with links that may be removed, in increasing order
inline void keep_clumps(const std::vector<Vec3>& points,
                        const Proximity_graph& graph,
                        const std::vector<std::uint32_t>& suspects,
                        std::vector<char>& is_dropped)
{
  struct Drop
  {
    double squared_length;
    std::uint32_t i, j;
    bool operator<(const Drop& other) const
    {
      return std::tie(squared_length, i, j) < std::tie(other.squared_length, other.i, other.j);
    }
  };
  std::vector<Drop> drops;
  for (const std::uint32_t i : suspects)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      if (is_dropped[e] && graph.neighbor[e] > i)
        drops.push_back(
            {(points[graph.neighbor[e]] - points[i]).squaredNorm(), i, graph.neighbor[e]});
  if (drops.empty())
    return;
  Point_sets sets(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e)
      if (!is_dropped[e])
        sets.join(static_cast<std::uint32_t>(i), graph.neighbor[e]);
  std::sort(drops.begin(), drops.end());
  const auto keep = [&](std::uint32_t i, std::uint32_t j) {
    const auto found = std::lower_bound(graph.neighbor.begin() + graph.first[i],
                                        graph.neighbor.begin() + graph.first[i + 1],
                                        j);
    is_dropped[static_cast<std::size_t>(found - graph.neighbor.begin())] = 0;
  };
  for (const Drop& d : drops)
    if (sets.find(d.i) != sets.find(d.j) &&
        std::min(sets.size(d.i), sets.size(d.j)) <= largest_clump) {
      sets.join(d.i, d.j);
      keep(d.i, d.j);
      keep(d.j, d.i);
    }
}

} // namespace internal

/*!
  Removes links that leave the surface at both ends and whose ends have no common neighbour. They
  occur between sheets whose distance is close to the point spacing, because the nearest neighbours
  of a point then include points of the other sheet.

  Links in volumes, on lines and of outliers are kept, because there is no surface. No point loses
  all its links. O(n k).
  \return the number of links removed [count]
*/
template <class ConcurrencyTag>
std::size_t drop_short_cuts(const std::vector<Vec3>& points, Proximity_graph& graph)
{
  using internal::Surface_normal;
  constexpr float smallest_confidence = 0.05f;
  auto normal = internal::surface_normals<ConcurrencyTag>(points, graph);
  for (int round = 0; round < 2; ++round)
    normal = internal::settled_normals<ConcurrencyTag>(graph, normal);

  const auto leaves_surface = [&](std::size_t i, const Vec3& e, double squared) {
    const Surface_normal& n = normal[i];
    const double height = double(n[0]) * e.x() + double(n[1]) * e.y() + double(n[2]) * e.z();
    return n[3] > smallest_confidence &&
           height * height > smallest_short_cut_sine * smallest_short_cut_sine * squared;
  };
  std::vector<char> is_suspected(graph.neighbor.size(), 0);
  std::vector<std::uint32_t> trusted_degree(points.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const Vec3 edge = points[j] - points[i];
      const double squared = edge.squaredNorm();
      is_suspected[e] =
          leaves_surface(i, edge, squared) && leaves_surface(j, edge, squared) ? 1 : 0;
      trusted_degree[i] += is_suspected[e] ? 0u : 1u;
    }
  });
  std::vector<std::uint32_t> suspects; // few points, or none
  for (std::size_t i = 0; i < points.size(); ++i)
    if (trusted_degree[i] < graph.degree(i))
      suspects.push_back(static_cast<std::uint32_t>(i));
  if (suspects.empty())
    return 0;
  const auto have_common_neighbor = [&](std::size_t i, std::size_t j) {
    for (std::size_t a = graph.first[i], b = graph.first[j];
         a < graph.first[i + 1] && b < graph.first[j + 1];) {
      if (graph.neighbor[a] == graph.neighbor[b]) {
        if (!is_suspected[a] && !is_suspected[b])
          return true;
        ++a;
        ++b;
      } else if (graph.neighbor[a] < graph.neighbor[b])
        ++a;
      else
        ++b;
    }
    return false;
  };
  std::vector<char> is_dropped(graph.neighbor.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(suspects.size(), [&](std::size_t s) {
    const std::size_t i = suspects[s];
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      is_dropped[e] = is_suspected[e] && trusted_degree[i] >= smallest_remaining_degree &&
                              trusted_degree[j] >= smallest_remaining_degree &&
                              !have_common_neighbor(i, j)
                          ? 1
                          : 0;
    }
  });
  internal::keep_clumps(points, graph, suspects, is_dropped);
  std::size_t kept = graph.first[suspects.front()]; // rows before keep their place
  for (std::size_t i = suspects.front(); i < points.size(); ++i) {
    const std::size_t begin = graph.first[i], end = graph.first[i + 1];
    graph.first[i] = static_cast<std::uint32_t>(kept);
    for (std::size_t e = begin; e < end; ++e)
      if (!is_dropped[e])
        graph.neighbor[kept++] = graph.neighbor[e];
  }
  const std::size_t dropped = (graph.neighbor.size() - kept) / 2;
  graph.first[points.size()] = static_cast<std::uint32_t>(kept);
  graph.neighbor.resize(kept);
  return dropped;
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_DROP_SHORT_CUTS_H
