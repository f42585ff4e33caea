// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of single points far from all others, which keep one link each.

#ifndef PCS_NEIGHBORHOOD_DETACH_OUTLIERS_H
#define PCS_NEIGHBORHOOD_DETACH_OUTLIERS_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/median_link.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace neighborhood {

/// A point is an outlier if its shortest link is longer than this many spacings of its neighbours.
/// The probability of such a link is below 1e-15 for six nearest neighbours among uniformly random
/// points on a surface. [-]
constexpr double smallest_outlier_gap = 3;

/// A point far from all others, and the nearest point that is not an outlier.
struct Outlier
{
  std::uint32_t point, host;
};

namespace internal {

/// Returns the length of the shortest link of each point, 0 without links.
template <class ConcurrencyTag>
std::vector<double> shortest_links(const std::vector<Eigen::Vector3d>& points,
                                   const Proximity_graph& graph)
{
  std::vector<double> shortest(points.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    double least = std::numeric_limits<double>::infinity();
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      least = std::min(least, (points[*j] - points[i]).squaredNorm());
    if (graph.degree(i) > 0)
      shortest[i] = std::sqrt(least);
  });
  return shortest;
}

/// Returns 1 for points whose shortest link is much longer than the spacing of their neighbours.
template <class ConcurrencyTag>
std::vector<char> mark_outliers(const std::vector<Eigen::Vector3d>& points,
                                const Proximity_graph& graph)
{
  const std::size_t n = points.size();
  const std::vector<double> shortest = shortest_links<ConcurrencyTag>(points, graph);
  std::vector<char> is_outlier(n, 0);
  pcs::internal::for_each_block<ConcurrencyTag>(n, 512, [&](std::size_t begin, std::size_t end) {
    std::vector<double> spacings;
    for (std::size_t i = begin; i < end; ++i) {
      const double longest = shortest[i] / smallest_outlier_gap;
      // medians of links are at least the shortest links, which excludes nearly all points
      const auto smaller = std::count_if(graph.begin(i), graph.end(i), [&](std::uint32_t j) {
        return shortest[j] < longest;
      });
      if (smaller <= static_cast<std::ptrdiff_t>(graph.degree(i) / 2))
        continue;
      spacings.clear();
      for (auto j = graph.begin(i); j != graph.end(i); ++j)
        spacings.push_back(median_link(points, graph, *j));
      is_outlier[i] = shortest[i] > smallest_outlier_gap * pcs::internal::upper_median(spacings);
    }
  });
  return is_outlier;
}

/// Returns outliers with a host: the nearest neighbour that is not an outlier and has other
/// neighbours.
inline std::vector<Outlier> find_hosts(const std::vector<Eigen::Vector3d>& points,
                                       const Proximity_graph& graph,
                                       const std::vector<char>& is_outlier)
{
  std::vector<Outlier> outliers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_outlier[i])
      continue;
    double nearest = std::numeric_limits<double>::infinity();
    Outlier outlier{static_cast<std::uint32_t>(i), 0};
    for (auto j = graph.begin(i); j != graph.end(i); ++j) {
      const double d = (points[*j] - points[i]).squaredNorm();
      const bool is_left_alone = std::all_of(graph.begin(*j), graph.end(*j), [&](std::uint32_t k) {
        return is_outlier[k] != 0;
      });
      if (!is_outlier[*j] && !is_left_alone && d < nearest) {
        nearest = d;
        outlier.host = *j;
      }
    }
    if (nearest < std::numeric_limits<double>::infinity())
      outliers.push_back(outlier);
  }
  return outliers;
}

/// Removes all links of outliers except those to their hosts.
inline void drop_links_of_outliers(const std::vector<Outlier>& outliers, Proximity_graph& graph)
{
  const std::size_t n = graph.first.size() - 1;
  std::vector<char> is_outlier(n, 0);
  std::vector<std::uint32_t> host(n, 0);
  for (const Outlier& o : outliers) {
    is_outlier[o.point] = 1;
    host[o.point] = o.host;
  }
  const auto is_kept = [&](std::size_t i, std::uint32_t j) {
    return (!is_outlier[i] || host[i] == j) && (!is_outlier[j] || host[j] == i);
  };
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t begin = graph.first[i], end = graph.first[i + 1];
    graph.first[i] = static_cast<std::uint32_t>(kept);
    for (std::size_t e = begin; e < end; ++e)
      if (is_kept(i, graph.neighbor[e]))
        graph.neighbor[kept++] = graph.neighbor[e];
  }
  graph.first[n] = static_cast<std::uint32_t>(kept);
  graph.neighbor.resize(kept);
}

} // namespace internal

/*!
  Removes all links of every outlier except the shortest, so that an outlier follows one point and
  does not affect others.

  Outliers are detected relative to the spacings of their neighbours, which adapts the criterion to
  dense and sparse regions. No point loses all its links. O(n k).
  \return the outliers, increasing by point
*/
template <class ConcurrencyTag>
std::vector<Outlier> detach_outliers(const std::vector<Eigen::Vector3d>& points,
                                     Proximity_graph& graph)
{
  const std::vector<char> is_outlier = internal::mark_outliers<ConcurrencyTag>(points, graph);
  std::vector<Outlier> outliers = internal::find_hosts(points, graph, is_outlier);
  if (!outliers.empty())
    internal::drop_links_of_outliers(outliers, graph);
  return outliers;
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_DETACH_OUTLIERS_H
