// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The nearest samples of a point, or of consecutive points, among given ones.

#ifndef PCS_DEFORMATION_BODY_NEAREST_SAMPLES_H
#define PCS_DEFORMATION_BODY_NEAREST_SAMPLES_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/neighborhood/nearest_lanes.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace deformation {
namespace internal {

/// A candidate sample of a point. Candidates are sorted by distance.
struct Sample_candidate
{
  double squared_distance; ///< [L^2]
  std::uint32_t sample;
  bool operator<(const Sample_candidate& other) const
  {
    return squared_distance != other.squared_distance ? squared_distance < other.squared_distance
                                                      : sample < other.sample;
  }
};

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
}

/*!
  The same for up to eight points of one region. Distances in single precision exclude nearly all
  samples that are not among the nearest ones; double precision decides among the others.
*/
class Ring_search
{
public:
  static constexpr std::size_t size = 8;

  Ring_search(const std::vector<Vec3>& sample_points, std::size_t k)
    : m_samples(sample_points), m_k(k)
  {
  }

  /// Prepares the search for `count` points of a region with samples in `ring`.
  void start(const Vec3* points,
             std::size_t count,
             std::uint32_t region,
             const std::vector<std::uint32_t>& ring)
  {
    m_points = points;
    m_ring = &ring;
    if (ring.size() <= m_k + 1)
      return;
    if (region != m_region)
      read_ring(region, ring);
    double reach = m_reach;
    for (std::size_t l = 0; l < size; ++l) {
      const Vec3 p = m_scale * (points[std::min(l, count - 1)] - m_center);
      reach = std::max(reach, p.norm());
      for (std::size_t c = 0; c < 3; ++c)
        m_query[c * size + l] = static_cast<float>(p[static_cast<Eigen::Index>(c)]);
    }
    m_smallest.assign(size * (m_k + 1), std::numeric_limits<float>::infinity());
    neighborhood::internal::lane_kernels().measure(
        {m_query,
         {m_candidate[0].data(), m_candidate[1].data(), m_candidate[2].data()},
         0,
         ring.size(),
         m_k + 1,
         m_smallest.data(),
         m_all.data()});
    constexpr double rounding = 4e-7; // coordinates are rounded to 2^-24
    float limit[size];
    for (std::size_t l = 0; l < size; ++l) {
      const double last = std::sqrt(double(m_smallest[size * m_k + l])) + 2 * rounding * reach;
      limit[l] = static_cast<float>((1 + 4 * rounding) * last * last);
    }
    m_hits.find(m_all.data(), ring.size(), limit, ring.data());
  }

  /// Finds the nearest samples of point `l`, nearest first.
  void nearest(std::size_t l, std::vector<Sample_candidate>& nearest)
  {
    if (m_ring->size() <= m_k + 1 || m_hits.count(l) != m_k + 1) {
      nearest_samples(m_points[l], m_samples, *m_ring, m_k, nearest);
      return;
    }
    m_found.clear();
    for (std::size_t a = 0; a <= m_k; ++a) {
      const std::uint32_t s = m_hits.of_query(l)[a];
      m_found.push_back({(m_samples[s] - m_points[l]).squaredNorm(), s});
    }
    sort_by_rank(nearest);
  }

private:
  void read_ring(std::uint32_t region, const std::vector<std::uint32_t>& ring)
  {
    m_region = region;
    m_center = m_samples[region];
    double reach = 0;
    for (const std::uint32_t s : ring)
      reach = std::max(reach, (m_samples[s] - m_center).norm());
    m_scale = 1 / reach; // positive, since samples are distinct
    m_reach = 1;
    for (std::size_t c = 0; c < 3; ++c) {
      m_candidate[c].clear();
      const auto axis = static_cast<Eigen::Index>(c);
      for (const std::uint32_t s : ring)
        m_candidate[c].push_back(
            static_cast<float>(m_scale * (m_samples[s][axis] - m_center[axis])));
    }
    m_all.resize(size * ring.size());
  }

  /// Sorts the samples found, which are in the order of their numbers, without branches.
  void sort_by_rank(std::vector<Sample_candidate>& sorted)
  {
    const std::size_t n = m_found.size();
    m_rank.assign(n, 0);
    for (std::size_t b = 1; b < n; ++b)
      for (std::size_t a = 0; a < b; ++a) {
        const bool is_b_first = m_found[b].squared_distance < m_found[a].squared_distance;
        m_rank[a] += is_b_first ? 1u : 0u;
        m_rank[b] += is_b_first ? 0u : 1u;
      }
    sorted.resize(n);
    for (std::size_t a = 0; a < n; ++a)
      sorted[m_rank[a]] = m_found[a];
  }

  const std::vector<Vec3>& m_samples;
  std::size_t m_k;
  const Vec3* m_points = nullptr;
  const std::vector<std::uint32_t>* m_ring = nullptr;
  std::uint32_t m_region = ~std::uint32_t(0);
  Vec3 m_center = Vec3::Zero();
  double m_scale = 1, m_reach = 1;
  float m_query[3 * size];
  std::vector<float> m_candidate[3], m_smallest, m_all;
  neighborhood::internal::Lane_hits m_hits;
  std::vector<Sample_candidate> m_found;
  std::vector<std::uint32_t> m_rank;
};

} // namespace internal
} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_NEAREST_SAMPLES_H
