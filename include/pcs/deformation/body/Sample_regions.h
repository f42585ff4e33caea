// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Geodesic regions of the samples on the neighbour graph, and their adjacency.

#ifndef PCS_DEFORMATION_BODY_SAMPLE_REGIONS_H
#define PCS_DEFORMATION_BODY_SAMPLE_REGIONS_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/internal/compress_rows.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <CGAL/tags.h>

#include <algorithm>
#include <atomic>
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

namespace internal {

/// The distance of a site to its sample in the upper half and the sample in the lower half, so that
/// one comparison finds the nearer sample, and the smaller number among equally near ones.
using Region_key = std::uint64_t;
constexpr Region_key unreached = ~Region_key(0);
/// Larger distances are equal to this one. No cloud has as many points as such a path.
constexpr Region_key largest_region_distance = 0xfffffffe;

inline Region_key region_key(Region_key distance, std::uint32_t sample)
{
  return std::min(distance, largest_region_distance) << 32 | sample;
}

/*!
  Shortest paths from the samples to the sites of one block of consecutive sites. Distances are
  whole numbers, so waiting sites are kept in lists, one for each distance.

  Keys only decrease, and the smallest ones do not depend on the order of the steps. Blocks can
  therefore run concurrently: each lowers keys of its neighbours, too, and reports these sites.
*/
template <class ConcurrencyTag>
class Region_block
{
public:
  using Keys = std::vector<std::atomic<Region_key>>;

  Region_block(const std::vector<Vec3>& points,
               const neighborhood::Proximity_graph& graph,
               double scale,
               Keys& keys)
    : m_points(points),
      m_graph(graph),
      m_squared_scale(scale * scale),
      m_keys(keys),
      m_head(largest_edge_steps + 1, none)
  {
  }

  /// Follows the edges from the sites `changed`, all in `[begin, end)`, whose keys were lowered,
  /// until no key of this block changes. Appends other sites whose keys were lowered to `outside`.
  void run(std::size_t begin,
           std::size_t end,
           const std::vector<std::uint32_t>& changed,
           std::vector<std::uint32_t>& outside)
  {
    m_starts.clear();
    for (const std::uint32_t site : changed)
      m_starts.emplace_back(distance(key(site)), site);
    std::sort(m_starts.begin(), m_starts.end());
    m_entries.clear();
    m_number_of_waiting = 0;
    auto start = m_starts.begin();
    for (Region_key d = 0; start != m_starts.end() || m_number_of_waiting > 0; ++d) {
      if (m_number_of_waiting == 0)
        d = std::max(d, start->first);
      for (; start != m_starts.end() && start->first == d; ++start)
        follow_edges(start->second, d, begin, end, outside);
      std::uint32_t entry = std::exchange(m_head[d % m_head.size()], none);
      for (; entry != none; entry = m_entries[entry].next) {
        --m_number_of_waiting;
        follow_edges(m_entries[entry].site, d, begin, end, outside);
      }
    }
  }

private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  struct Entry
  {
    std::uint32_t site, next;
  };

  static Region_key distance(Region_key key) { return key >> 32; }

  Region_key key(std::size_t site) const { return m_keys[site].load(std::memory_order_relaxed); }

  /// Lowers the key of a site. Returns `false` if it was not larger.
  bool lower(std::size_t site, Region_key value)
  {
    Region_key old = key(site);
    if constexpr (pcs::internal::is_parallel<ConcurrencyTag>()) {
      while (value < old)
        if (m_keys[site].compare_exchange_weak(old, value, std::memory_order_relaxed))
          return true;
      return false;
    }
    if (value < old)
      m_keys[site].store(value, std::memory_order_relaxed);
    return value < old;
  }

  /// Returns a length in steps, rounded, at least 1 and at most `largest_edge_steps`. `squared` is
  /// the squared length in steps.
  static Region_key rounded_steps(double squared)
  {
    const double length = std::min(std::sqrt(squared), double(largest_edge_steps));
    const auto whole = static_cast<Region_key>(length);
    return std::max<Region_key>(whole + (length - static_cast<double>(whole) >= 0.5 ? 1 : 0), 1);
  }

  /// Does nothing if the distance of `i` is smaller than `d`, as then it was or will be followed
  /// from there.
  void follow_edges(std::uint32_t i,
                    Region_key d,
                    std::size_t begin,
                    std::size_t end,
                    std::vector<std::uint32_t>& outside)
  {
    const Region_key from = key(i);
    if (distance(from) != std::min(d, largest_region_distance))
      return;
    const auto sample = static_cast<std::uint32_t>(from);
    for (auto j = m_graph.begin(i); j != m_graph.end(i); ++j) {
      const Region_key before = key(*j);
      if (before <= from) // an edge has at least one step
        continue;
      const double squared = m_squared_scale * (m_points[*j] - m_points[i]).squaredNorm();
      // Without a root: edges of half a step more than the difference reach `j` later.
      const double difference = static_cast<double>(distance(before) - distance(from)) + 0.5;
      if (squared > (1 + 1e-9) * difference * difference && difference < largest_edge_steps)
        continue;
      const Region_key through_i = d + rounded_steps(squared);
      if (!lower(*j, region_key(through_i, sample)))
        continue;
      if (*j < begin || *j >= end) {
        outside.push_back(*j);
        continue;
      }
      std::uint32_t& head = m_head[through_i % m_head.size()];
      m_entries.push_back({*j, head});
      head = static_cast<std::uint32_t>(m_entries.size() - 1);
      ++m_number_of_waiting;
    }
  }

  const std::vector<Vec3>& m_points;
  const neighborhood::Proximity_graph& m_graph;
  double m_squared_scale;
  Keys& m_keys;
  std::vector<std::uint32_t> m_head; ///< first entry of each distance
  std::vector<Entry> m_entries;
  std::vector<std::pair<Region_key, std::uint32_t>> m_starts; ///< distance, site
  std::size_t m_number_of_waiting = 0;
};

} // namespace internal

/*!
  Grows all samples at once over the edges, by length (Dijkstra with buckets). Ties go to the sample
  with the smaller number. O(n degree) for any number of samples; Algorithm 1 of [Aiteanu 2022]
  searches from every point. Blocks of consecutive points, which should be near each other, are
  searched one after another or concurrently, so that memory is read locally; the result is the
  same in any order.
*/
template <class ConcurrencyTag = CGAL::Sequential_tag>
Sample_regions grow_regions(const std::vector<Vec3>& points,
                            const neighborhood::Proximity_graph& graph,
                            const std::vector<std::uint32_t>& samples)
{
  using Block = internal::Region_block<ConcurrencyTag>;
  constexpr std::size_t block_size = 16384;
  const double edge = typical_edge<ConcurrencyTag>(points, graph);
  const double scale = edge > 0 ? steps_per_edge / edge : 1;
  const std::size_t n = points.size(), number_of_blocks = (n + block_size - 1) / block_size;
  typename Block::Keys keys(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    keys[i].store(internal::unreached, std::memory_order_relaxed);
  });
  std::vector<std::vector<std::uint32_t>> changed(number_of_blocks), outside;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    keys[samples[s]] = internal::region_key(0, static_cast<std::uint32_t>(s));
    changed[samples[s] / block_size].push_back(samples[s]);
  }
  std::vector<std::size_t> active;
  while (true) {
    active.clear();
    for (std::size_t b = 0; b < number_of_blocks; ++b)
      if (!changed[b].empty())
        active.push_back(b);
    if (active.empty())
      break;
    outside.resize(active.size());
    pcs::internal::for_each_block<ConcurrencyTag>(
        active.size(),
        4,
        [&](std::size_t begin, std::size_t end) {
          Block block(points, graph, scale, keys);
          for (std::size_t a = begin; a < end; ++a) {
            const std::size_t first = active[a] * block_size;
            outside[a].clear();
            block.run(first, first + block_size, changed[active[a]], outside[a]);
            changed[active[a]].clear();
          }
        });
    for (std::size_t a = 0; a < active.size(); ++a)
      for (const std::uint32_t site : outside[a])
        changed[site / block_size].push_back(site);
  }
  Sample_regions regions;
  regions.sample_of_point.resize(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    regions.sample_of_point[i] =
        static_cast<std::uint32_t>(keys[i].load(std::memory_order_relaxed));
  });
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

namespace internal {

/// An edge between the regions of two samples.
struct Region_crossing
{
  std::uint32_t from, to; ///< samples
  double length;          ///< `crossing_length()`
};

/// Returns the edges between regions, in the order of the rows of the graph.
template <class ConcurrencyTag>
std::vector<Region_crossing> region_crossings(const std::vector<Vec3>& points,
                                              const neighborhood::Proximity_graph& graph,
                                              const std::vector<std::uint32_t>& label)
{
  constexpr std::size_t block_size = 8192;
  std::vector<std::vector<Region_crossing>> found((points.size() + block_size - 1) / block_size);
  const auto find = [&](std::size_t begin, std::size_t end) {
    auto& crossings = found[begin / block_size];
    for (std::size_t i = begin; i < end; ++i)
      for (auto j = graph.begin(i); j != graph.end(i); ++j)
        if (label[i] != label[*j] && label[i] != no_sample)
          crossings.push_back({label[i], label[*j], crossing_length(points, graph, i, *j)});
  };
  pcs::internal::for_each_block<ConcurrencyTag>(points.size(), block_size, find);
  std::vector<Region_crossing> crossings;
  for (const auto& block : found)
    crossings.insert(crossings.end(), block.begin(), block.end());
  return crossings;
}

} // namespace internal

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
template <class ConcurrencyTag = CGAL::Sequential_tag>
Weighted_graph sample_graph(const std::vector<Vec3>& points,
                            const neighborhood::Proximity_graph& graph,
                            const std::vector<std::uint32_t>& samples,
                            const Sample_regions& regions,
                            double& weight_unit)
{
  using Crossing = internal::Region_crossing;
  const std::vector<Crossing> crossings =
      internal::region_crossings<ConcurrencyTag>(points, graph, regions.sample_of_point);
  std::vector<Crossing> ordered;
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
