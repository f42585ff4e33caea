// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Deformation of points that are not in the session, by the nearest samples.

#ifndef PCS_DEFORMATION_UPSAMPLING_POINT_CARRIER_H
#define PCS_DEFORMATION_UPSAMPLING_POINT_CARRIER_H

#include <pcs/core/Deformation_options.h>
#include <pcs/deformation/body/Sample_links.h>
#include <pcs/deformation/upsampling/blend_block.h>
#include <pcs/neighborhood/Nearest_neighbors.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  Blends the maps of the samples nearest to a point. The candidates are the samples in the rings
  around the region of the site nearest to the point. The weights equal those of a point of the
  session at the same position.

  If all sites are samples, every point of the session has the map of its own sample. The weights
  are then divided by the squared distances: the map of a sample is interpolated at its position,
  and the blended map is continuous.

  The object is built once per rest shape, and needs 40 bytes per site, and 30 per sample.
  `sample_of_site` must outlive it. Const functions may run concurrently. O(log n) per point for n
  sites.
*/
class Point_carrier
{
public:
  Point_carrier(std::vector<Vec3> sites,
                std::vector<Vec3> samples,
                const std::vector<std::uint32_t>& sample_of_site,
                neighborhood::Proximity_graph sample_graph,
                std::size_t number_of_sample_neighbors,
                Sample_weights weights)
    : m_sites(std::move(sites)),
      m_samples(std::move(samples)),
      m_sample_of_site(sample_of_site),
      m_sample_graph(std::move(sample_graph)),
      m_k(number_of_sample_neighbors),
      m_weights(weights),
      m_nearest(m_sites)
  {
    if (m_samples.size() < m_sites.size()) // otherwise the rings would need most of the memory
      m_rings = internal::sample_rings<CGAL::Sequential_tag>(m_sample_graph);
  }

  Point_carrier(const Point_carrier&) = delete;
  Point_carrier& operator=(const Point_carrier&) = delete;

  /// Returns the index of the site nearest to `point`.
  std::size_t nearest_site(const Vec3& point) const
  {
    thread_local std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
    m_nearest(point, 1, found);
    return found.front().index;
  }

  /// Returns the blended map at `point`, whose nearest site is `site`. `maps` are those of all
  /// samples.
  Affine_map map_at(const Vec3& point, std::size_t site, const std::vector<Affine_map>& maps) const
  {
    thread_local std::vector<internal::Sample_candidate> nearest;
    thread_local std::vector<double> weight;
    if (m_rings.empty()) {
      find_near_sites(point, site, nearest);
      if (!(nearest.front().squared_distance > 0))
        return maps[nearest.front().sample];
      interpolation_weights(nearest, m_k, weight);
    } else {
      internal::nearest_samples(point, m_samples, m_rings[m_sample_of_site[site]], m_k, nearest);
      internal::sample_weights(nearest, m_weights, m_k, weight);
    }
    Affine_map result{};
    for (std::size_t b = 0; b < weight.size(); ++b) {
      const Affine_map& map = maps[nearest[b].sample];
      for (int e = 0; e < 9; ++e)
        result.a[e] += weight[b] * map.a[e];
      for (int e = 0; e < 3; ++e)
        result.t[e] += weight[b] * map.t[e];
    }
    return result;
  }

private:
  /// Finds the sites nearest to `point` among `site` and the two rings of sites linked to it.
  void find_near_sites(const Vec3& point,
                       std::size_t site,
                       std::vector<internal::Sample_candidate>& nearest) const
  {
    thread_local std::vector<std::uint32_t> ring;
    ring.assign(1, static_cast<std::uint32_t>(site));
    for (auto t = m_sample_graph.begin(site); t != m_sample_graph.end(site); ++t) {
      ring.push_back(*t);
      ring.insert(ring.end(), m_sample_graph.begin(*t), m_sample_graph.end(*t));
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    // outliers have one link, and their maps are those of the site to which they are attached
    const auto is_other_outlier = [&](std::uint32_t s) {
      return s != site && m_sample_graph.degree(s) == 1;
    };
    ring.erase(std::remove_if(ring.begin(), ring.end(), is_other_outlier), ring.end());
    internal::nearest_samples(point, m_samples, ring, m_k, nearest);
  }

  /// Returns compact weights divided by the squared distances, which are positive.
  static void interpolation_weights(const std::vector<internal::Sample_candidate>& nearest,
                                    std::size_t k,
                                    std::vector<double>& weight)
  {
    internal::sample_weights(nearest, Sample_weights::compact, k, weight);
    const double least = nearest.front().squared_distance;
    double sum = 0;
    for (std::size_t b = 0; b < weight.size(); ++b) {
      weight[b] *= least / nearest[b].squared_distance;
      sum += weight[b];
    }
    for (double& w : weight)
      w /= sum;
  }

  std::vector<Vec3> m_sites, m_samples;
  const std::vector<std::uint32_t>& m_sample_of_site;
  neighborhood::Proximity_graph m_sample_graph;
  std::vector<std::vector<std::uint32_t>> m_rings;
  std::size_t m_k;
  Sample_weights m_weights;
  neighborhood::Nearest_neighbors m_nearest;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_POINT_CARRIER_H
