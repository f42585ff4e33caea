// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Geodesic regions of the samples on the neighbour graph, and their adjacency.

#ifndef PCS_DEFORMATION_BODY_SAMPLE_REGIONS_H
#define PCS_DEFORMATION_BODY_SAMPLE_REGIONS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/internal/compress_rows.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

constexpr std::uint32_t no_sample = ~std::uint32_t(0);

/// The sample that is nearest along the graph, for every point; `no_sample` in components without
/// samples.
struct Sample_regions
{
  std::vector<std::uint32_t> sample_of_point;
};

/// Edge lengths are counted in this fraction of `typical_edge()`: whole numbers make ties exact, so
/// that rounding (a translated copy of the cloud) cannot decide them, and need no heap.
constexpr double steps_per_edge = 64;
/// Longer edges count as this long. Only outliers have such edges.
constexpr std::uint32_t largest_edge_steps = 4096;

/*!
  Grows all samples at once over the edges, by length (Dijkstra with buckets). Ties go to the sample
  with the smaller number. O(n degree) for any number of samples; Algorithm 1 of [Aiteanu 2022]
  searches from every point.
*/
inline Sample_regions grow_regions(const std::vector<Vec3>& points,
                                   const neighborhood::Proximity_graph& graph,
                                   const std::vector<std::uint32_t>& samples)
{
  constexpr auto infinity = std::numeric_limits<std::uint64_t>::max();
  const double edge = typical_edge(points, graph);
  const double scale = edge > 0 ? steps_per_edge / edge : 1;
  Sample_regions regions;
  regions.sample_of_point.assign(points.size(), no_sample);
  std::vector<std::uint64_t> distance(points.size(), infinity);
  std::vector<std::vector<std::uint32_t>> bucket(largest_edge_steps + 1);
  std::size_t number_of_waiting = samples.size();
  for (std::size_t s = 0; s < samples.size(); ++s) {
    distance[samples[s]] = 0;
    regions.sample_of_point[samples[s]] = static_cast<std::uint32_t>(s);
    bucket[0].push_back(samples[s]);
  }
  // Every edge takes at least one step. The entries of a bucket are therefore final when it is
  // read, and their order does not matter.
  for (std::uint64_t d = 0; number_of_waiting > 0; ++d) {
    auto& now = bucket[d % bucket.size()];
    number_of_waiting -= now.size();
    for (const std::uint32_t i : now) {
      if (distance[i] != d)
        continue;
      const std::uint32_t s = regions.sample_of_point[i];
      for (auto j = graph.begin(i); j != graph.end(i); ++j) {
        if (distance[*j] <= d)
          continue;
        const double steps = std::round(scale * (points[*j] - points[i]).norm());
        const std::uint64_t through_i =
            d +
            static_cast<std::uint64_t>(std::min(std::max(steps, 1.0), double(largest_edge_steps)));
        std::uint32_t& label = regions.sample_of_point[*j];
        if (through_i < distance[*j]) {
          distance[*j] = through_i;
          label = s;
          bucket[through_i % bucket.size()].push_back(*j);
          ++number_of_waiting;
        } else if (through_i == distance[*j])
          label = std::min(label, s);
      }
    }
    now.clear();
  }
  return regions;
}

/// Length that an edge adds to the border that it crosses: at most the spacing, so that outliers
/// count little. [L]
inline double crossing_length(const std::vector<Vec3>& points,
                              const neighborhood::Proximity_graph& graph,
                              std::size_t i,
                              std::size_t j)
{
  return std::min({(points[j] - points[i]).norm(),
                   local_spacing(points, graph, i),
                   local_spacing(points, graph, j)});
}

/// Edges to outliers get weights that fall with the square of their length: fits weigh an edge by
/// its weight times its squared length, which must not grow without bound. Returns the sum of the
/// weights.
inline double damp_long_edges(const std::vector<Vec3>& points,
                              const std::vector<std::uint32_t>& samples,
                              Weighted_graph& graph)
{
  const auto length = [&](std::size_t s, std::size_t e) {
    return (points[samples[graph.neighbor[e]]] - points[samples[s]]).norm();
  };
  std::vector<double> lengths;
  for (std::size_t s = 0; s < graph.size(); ++s)
    for (std::size_t e = graph.first[s]; e < graph.first[s + 1]; ++e)
      lengths.push_back(length(s, e));
  if (lengths.empty())
    return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double longest = longest_typical_edge * *middle;
  double sum = 0;
  for (std::size_t s = 0; s < graph.size(); ++s)
    for (std::size_t e = graph.first[s]; e < graph.first[s + 1]; ++e) {
      const double d = length(s, e);
      if (d > longest)
        graph.weight[e] = representable_weight(graph.weight[e] * (longest / d));
      sum += graph.weight[e];
    }
  return sum;
}

/*!
  Links samples whose regions touch. Parts that are near in space but not along the graph stay
  unlinked.

  The weight is that of a Voronoi cell Laplacian: the length of the common border divided by the
  distance of the samples, scaled to mean 1. The length of the border is the sum of the lengths of
  the edges that cross it, each limited to the local spacing. `weight_unit` receives the weight of
  an edge whose border is as long as itself.
*/
inline Weighted_graph sample_graph(const std::vector<Vec3>& points,
                                   const neighborhood::Proximity_graph& graph,
                                   const std::vector<std::uint32_t>& samples,
                                   const Sample_regions& regions,
                                   double& weight_unit)
{
  struct Crossing
  {
    std::uint32_t from, to; // samples
    double length;
  };
  std::vector<Crossing> crossings, ordered;
  const auto& label = regions.sample_of_point;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      if (label[i] != label[*j] && label[i] != no_sample)
        crossings.push_back({label[i], label[*j], crossing_length(points, graph, i, *j)});
  const auto first = pcs::internal::compress_rows<std::size_t>(
      samples.size(),
      crossings.size(),
      [&](std::size_t c) { return crossings[c].from; },
      [&](std::size_t count) { ordered.resize(count); },
      [&](std::size_t c, std::size_t at) { ordered[at] = crossings[c]; });
  Weighted_graph result;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    // Stable: the sums below are then formed in the order of the points on every platform.
    const auto end = ordered.begin() + static_cast<std::ptrdiff_t>(first[s + 1]);
    auto c = ordered.begin() + static_cast<std::ptrdiff_t>(first[s]);
    std::stable_sort(c, end, [](const Crossing& a, const Crossing& b) { return a.to < b.to; });
    while (c != end) {
      const std::uint32_t t = c->to;
      double border = 0;
      for (; c != end && c->to == t; ++c)
        border += c->length;
      result.neighbor.push_back(t);
      result.weight.push_back(
          representable_weight(border / (points[samples[t]] - points[samples[s]]).norm()));
    }
    result.first.push_back(static_cast<std::uint32_t>(result.neighbor.size()));
  }
  // Both half-edges of a pair were summed in different orders: give them the same bits.
  for (std::size_t s = 0; s < samples.size(); ++s)
    for (std::size_t e = result.first[s]; e < result.first[s + 1]; ++e) {
      const std::uint32_t t = result.neighbor[e];
      if (t < s)
        continue;
      const auto back =
          std::lower_bound(result.begin(t), result.end(t), static_cast<std::uint32_t>(s));
      result.weight[static_cast<std::size_t>(back - result.neighbor.data())] = result.weight[e];
    }
  const double sum = damp_long_edges(points, samples, result);
  weight_unit = sum > 0 ? static_cast<double>(result.weight.size()) / sum : 1;
  for (double& w : result.weight)
    w *= weight_unit;
  return result;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_SAMPLE_REGIONS_H
