// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Weights of the geodesically nearest samples of every point.

#ifndef PCS_DEFORMATION_BODY_SAMPLE_LINKS_H
#define PCS_DEFORMATION_BODY_SAMPLE_LINKS_H

#include <pcs/core/Deformation_options.h>
#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {

namespace deformation {

/// `k` samples per point with weights that sum to one; unused entries are `no_sample` and weight 0.
struct Sample_links
{
  std::size_t k = 0;
  std::vector<std::uint32_t> sample;
  std::vector<float> weight;
};

namespace internal {

/// A candidate sample of a point. Candidates are sorted by distance.
struct Sample_candidate
{
  double distance;
  std::uint32_t sample;
  bool operator<(const Sample_candidate& other) const
  {
    return distance != other.distance ? distance < other.distance : sample < other.sample;
  }
};

/// Returns the weights of the first `k` candidates, which sum to one; empty without candidates.
inline void sample_weights(const std::vector<Sample_candidate>& nearest,
                           Sample_weights kind,
                           std::size_t k,
                           std::vector<double>& weight)
{
  weight.assign(std::min(k, nearest.size()), 1);
  if (nearest.empty())
    return;
  // With fewer than K + 1 samples in reach, the support ends beyond the last sample.
  const double support = nearest.size() > k ? nearest[k].distance : 1.5 * nearest.back().distance;
  double sum = 0;
  for (std::size_t b = 0; b < weight.size(); ++b) {
    const double d = nearest[b].distance;
    if (kind == Sample_weights::compact) {
      const double f = support > 0 ? std::max(0.0, 1 - (d / support) * (d / support)) : 1;
      weight[b] = f * f;
    } else // the point may be the sample itself
      weight[b] = 1 / std::max(d * d, 1e-24 * support * support + 1e-300);
    sum += weight[b];
  }
  if (!(sum > 0)) { // K + 1 samples at the same distance
    weight.assign(weight.size(), 1);
    sum = static_cast<double>(weight.size());
  }
  // Round to the 16 bits in which weights are stored; the nearest sample gets the remainder.
  double others = 0;
  for (std::size_t b = weight.size(); b-- > 0;) {
    weight[b] = std::round(weight_steps * weight[b] / sum) / weight_steps;
    if (b > 0)
      others += weight[b];
  }
  weight[0] = std::max(0.0, 1 - others);
}

inline void write_links(const std::vector<Sample_candidate>& nearest,
                        const std::vector<double>& weight,
                        std::size_t point,
                        Sample_links& links)
{
  for (std::size_t b = 0; b < weight.size(); ++b) {
    links.sample[point * links.k + b] = nearest[b].sample;
    links.weight[point * links.k + b] = static_cast<float>(weight[b]);
  }
}

/// Returns for every sample, in increasing order, the sample itself and the samples in the two
/// rings of regions that touch its region.
template <class ConcurrencyTag>
std::vector<std::vector<std::uint32_t>> sample_rings(const Weighted_graph& graph)
{
  std::vector<std::vector<std::uint32_t>> rings(graph.size());
  pcs::internal::for_each_index<ConcurrencyTag>(
      rings.size(),
      [&](std::size_t s) {
        auto& ring = rings[s];
        ring.push_back(static_cast<std::uint32_t>(s));
        for (auto t = graph.begin(s); t != graph.end(s); ++t) {
          ring.push_back(*t);
          ring.insert(ring.end(), graph.begin(*t), graph.end(*t));
        }
        std::sort(ring.begin(), ring.end());
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
      },
      256);
  return rings;
}

/// Finds the `k + 1` nearest samples of the ring, nearest first, or all if there are fewer.
inline void nearest_samples(const Vec3& point,
                            const std::vector<Vec3>& sample_points,
                            const std::vector<std::uint32_t>& ring,
                            std::size_t k,
                            std::vector<Sample_candidate>& nearest)
{
  nearest.clear();
  for (const auto s : ring)
    nearest.push_back({(sample_points[s] - point).squaredNorm(), s});
  const std::size_t count = std::min(k + 1, nearest.size());
  std::partial_sort(nearest.begin(),
                    nearest.begin() + static_cast<std::ptrdiff_t>(count),
                    nearest.end());
  nearest.resize(count);
  for (auto& candidate : nearest)
    candidate.distance = std::sqrt(candidate.distance);
}

} // namespace internal

/*!
  Finds the nearest samples, by Euclidean distance, among the two rings of touching regions around
  the region of each point.

  On a smooth surface, distances within two regions are almost geodesic, and unlike sums of edges
  they are smooth functions of the point. The rings follow the surface and exclude samples that are
  near in space only. Points are independent of each other. O(n ring).
*/
template <class ConcurrencyTag>
Sample_links link_by_regions(const std::vector<Vec3>& points,
                             const std::vector<std::uint32_t>& samples,
                             const Sample_regions& regions,
                             const Weighted_graph& graph,
                             std::size_t k,
                             Sample_weights weights)
{
  Sample_links links;
  links.k = k;
  links.sample.assign(points.size() * k, no_sample);
  links.weight.assign(points.size() * k, 0);
  const auto rings = internal::sample_rings<ConcurrencyTag>(graph);
  std::vector<Vec3> sample_points;
  for (const auto s : samples)
    sample_points.push_back(points[s]);
  pcs::internal::for_each_block<ConcurrencyTag>(
      points.size(),
      1024,
      [&](std::size_t begin, std::size_t end) {
        std::vector<internal::Sample_candidate> nearest;
        std::vector<double> weight;
        for (std::size_t i = begin; i < end; ++i) {
          if (regions.sample_of_point[i] == no_sample)
            continue;
          internal::nearest_samples(points[i],
                                    sample_points,
                                    rings[regions.sample_of_point[i]],
                                    k,
                                    nearest);
          internal::sample_weights(nearest, weights, k, weight);
          internal::write_links(nearest, weight, i, links);
        }
      });
  return links;
}

/*!
  Finds for each point the `k` samples with the fewest hops: all samples propagate over the graph
  simultaneously, one hop per round. The result equals a breadth-first search from every point up to
  ties, in O(n k degree) instead of O(n r).
*/
template <class ConcurrencyTag>
Sample_links link_by_hops(const std::vector<Vec3>& points,
                          const neighborhood::Proximity_graph& graph,
                          const std::vector<std::uint32_t>& samples,
                          std::size_t k,
                          Sample_weights weights)
{
  const std::size_t wanted = k + 1; // the last one ends the support of the compact weights
  std::vector<std::uint32_t> label(points.size() * wanted, no_sample);
  std::vector<std::uint8_t> count(points.size(), 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> front, next; // point, sample
  for (std::size_t s = 0; s < samples.size(); ++s)
    front.emplace_back(samples[s], static_cast<std::uint32_t>(s));
  const auto accept = [&](std::uint32_t point, std::uint32_t sample) {
    auto* row = label.data() + point * wanted;
    if (count[point] == wanted || std::find(row, row + count[point], sample) != row + count[point])
      return false;
    row[count[point]++] = sample;
    return true;
  };
  while (!front.empty()) {
    // Sorting makes the order of arrival, and thus every tie, the same on every machine.
    std::sort(front.begin(), front.end());
    front.erase(std::unique(front.begin(), front.end()), front.end());
    next.clear();
    for (const auto& [point, sample] : front)
      if (accept(point, sample))
        for (auto j = graph.begin(point); j != graph.end(point); ++j)
          if (count[*j] < wanted)
            next.emplace_back(*j, sample);
    front.swap(next);
  }
  Sample_links links;
  links.k = k;
  links.sample.assign(points.size() * k, no_sample);
  links.weight.assign(points.size() * k, 0);
  pcs::internal::for_each_block<ConcurrencyTag>(
      points.size(),
      1024,
      [&](std::size_t begin, std::size_t end) {
        std::vector<internal::Sample_candidate> nearest;
        std::vector<double> weight;
        for (std::size_t i = begin; i < end; ++i) {
          nearest.clear();
          for (std::size_t b = 0; b < count[i]; ++b) {
            const std::uint32_t s = label[i * wanted + b];
            nearest.push_back({(points[samples[s]] - points[i]).norm(), s});
          }
          std::sort(nearest.begin(), nearest.end());
          internal::sample_weights(nearest, weights, k, weight);
          internal::write_links(nearest, weight, i, links);
        }
      });
  return links;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_SAMPLE_LINKS_H
