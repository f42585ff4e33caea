// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Weights of the geodesically nearest samples of every point.

#ifndef PCS_DEFORMATION_BODY_SAMPLE_LINKS_H
#define PCS_DEFORMATION_BODY_SAMPLE_LINKS_H

#include <pcs/core/Deformation_options.h>
#include <pcs/deformation/body/Sample_regions.h>
#include <pcs/deformation/body/nearest_samples.h>
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

/// Rounds a value in [0, 2^31) half up.
inline double rounded(double x)
{
  const double whole = static_cast<double>(static_cast<std::int32_t>(x));
  return whole + (x - whole >= 0.5 ? 1 : 0);
}

/// Returns the weights of the first `k` candidates, which sum to one; empty without candidates.
inline void sample_weights(const std::vector<Sample_candidate>& nearest,
                           Sample_weights kind,
                           std::size_t k,
                           std::vector<double>& weight)
{
  weight.assign(std::min(k, nearest.size()), 1);
  if (nearest.empty())
    return;
  // With fewer than K + 1 samples in reach, the support ends beyond the last sample. [L^2]
  const double support = nearest.size() > k ? nearest[k].squared_distance
                                            : 1.5 * 1.5 * nearest.back().squared_distance;
  const double scale = support > 0 ? 1 / support : 0;
  double sum = 0;
  for (std::size_t b = 0; b < weight.size(); ++b) {
    const double squared = nearest[b].squared_distance;
    if (kind == Sample_weights::compact) {
      const double f = std::max(0.0, 1 - squared * scale);
      weight[b] = f * f;
    } else // the point may be the sample itself
      weight[b] = 1 / std::max(squared, 1e-24 * support + 1e-300);
    sum += weight[b];
  }
  if (!(sum > 0)) { // K + 1 samples at the same distance
    weight.assign(weight.size(), 1);
    sum = static_cast<double>(weight.size());
  }
  // Round to the 16 bits in which weights are stored; the nearest sample gets the remainder.
  const double steps = weight_steps / sum;
  double others = 0;
  for (std::size_t b = weight.size(); b-- > 0;) {
    weight[b] = rounded(steps * weight[b]) / weight_steps;
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
std::vector<std::vector<std::uint32_t>> sample_rings(const neighborhood::Proximity_graph& graph)
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
        const auto& label = regions.sample_of_point;
        internal::Ring_search search(sample_points, k);
        std::vector<internal::Sample_candidate> nearest;
        std::vector<double> weight;
        std::size_t next = begin;
        for (std::size_t i = begin; i < end; i = next) {
          // consecutive points of the same region have the same candidates
          while (next < end && next < i + internal::Ring_search::size && label[next] == label[i])
            ++next;
          if (label[i] == no_sample)
            continue;
          search.start(points.data() + i, next - i, label[i], rings[label[i]]);
          for (std::size_t l = 0; l < next - i; ++l) {
            search.nearest(l, nearest);
            internal::sample_weights(nearest, weights, k, weight);
            internal::write_links(nearest, weight, i + l, links);
          }
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
            nearest.push_back({(points[samples[s]] - points[i]).squaredNorm(), s});
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
