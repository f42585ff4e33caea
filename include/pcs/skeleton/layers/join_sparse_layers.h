// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Thicker level sets for stems with a point spacing larger than the thickness of a level set.

#ifndef PCS_SKELETON_LAYERS_JOIN_SPARSE_LAYERS_H
#define PCS_SKELETON_LAYERS_JOIN_SPARSE_LAYERS_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options for joining sparse level sets.
struct Sparse_layer_options
{
  double thinnest = 1.3;  ///< least thickness of a connected level set, in local spacings [-]
  int doublings = 4;      ///< the thickness grows at most by two to this power [count]
  std::size_t fewest = 8; ///< least number of points of a joined level set [count]
  double radius = 2.5;    ///< its least radius, in local spacings: thinner sets are connected [-]
  double band = 0.2;      ///< largest deviation from a circle, in radii [-]
  int sectors = 6;        ///< least number of sectors, of 12, with points [count]
};

namespace internal {

/// Returns how often the thickness of the level sets at each point must be doubled to connect them.
template <class ConcurrencyTag>
std::vector<std::uint8_t> doublings_of_layers(const Scan& scan,
                                              const std::vector<Index>& layer,
                                              double thickness,
                                              const Sparse_layer_options& rules)
{
  std::vector<std::uint8_t> level(scan.size(), 0);
  pcs::internal::for_each_index<ConcurrencyTag>(scan.size(), [&](std::size_t i) {
    if (layer[i] == none || rules.thinnest * scan.local_spacing[i] <= thickness)
      return;
    std::array<double, neighbors_per_point> others;
    std::size_t count = 0;
    for (const Index j : scan.neighbors[i])
      if (j != none)
        others[count++] = scan.local_spacing[j];
    if (count == 0)
      return;
    const double middle =
        pcs::internal::upper_median(others.begin(),
                                    others.begin() + static_cast<std::ptrdiff_t>(count));
    // long steps have a cost larger than their length
    const double wanted =
        rules.thinnest * middle * std::max(1.0, middle / (cheap_step * scan.spacing));
    while (level[i] < rules.doublings && std::ldexp(thickness, level[i]) < wanted)
      ++level[i];
  });
  return level;
}

/// Joins level-set components that together lie on circles, where scans are sparse.
class Sparse_layer_joiner
{
  using Member = std::pair<Index, Index>; // a set and a point of it

public:
  Sparse_layer_joiner(const Scan& scan,
                      const std::vector<double>& distance,
                      const std::vector<Index>& layer,
                      const Sparse_layer_options& rules,
                      std::vector<std::uint8_t> level)
    : m_scan(scan), m_distance(distance), m_layer(layer), m_rules(rules), m_level(std::move(level))
  {
  }

  template <class LinkRange>
  void run(const LinkRange& links, Point_sets& sets) const
  {
    Links sparse; // few in most scans
    for_each_link(links, [&](const Link& l) {
      if (m_level[l.first] > 0 && m_level[l.second] > 0)
        sparse.push_back(l);
    });
    for (int level = 1; level <= m_rules.doublings && !sparse.empty(); ++level) {
      sparse.erase(std::remove_if(sparse.begin(),
                                  sparse.end(),
                                  [&](const Link& l) {
                                    return std::min(m_level[l.first], m_level[l.second]) < level;
                                  }),
                   sparse.end());
      Point_sets joined = sets;
      for (const Link& l : sparse)
        if ((m_layer[l.first] >> level) == (m_layer[l.second] >> level))
          joined.unite(l.first, l.second);
      std::vector<Member> members; // set and point
      for (Index i = 0; i < m_level.size(); ++i)
        if (m_level[i] >= level)
          members.emplace_back(joined.find(i), i);
      std::sort(members.begin(), members.end());
      for (std::size_t b = 0, e = 0; b < members.size(); b = e) {
        bool is_whole = true;
        for (; e < members.size() && members[e].first == members[b].first; ++e)
          is_whole = is_whole && sets.find(members[e].second) == sets.find(members[b].second);
        if (is_whole || e - b < m_rules.fewest || !is_ring(&members[b], &members[e - 1] + 1))
          continue;
        for (std::size_t k = b + 1; k < e; ++k)
          sets.unite(members[b].second, members[k].second);
      }
    }
  }

private:
  /// Returns whether the points lie on a circle about the direction of increasing path length.
  bool is_ring(const Member* begin, const Member* end) const
  {
    const double n = double(end - begin);
    Vec3 mean = Vec3::Zero();
    double middle = 0, spacing = 0;
    for (const Member* m = begin; m != end; ++m) {
      mean += m_scan.points[m->second] / n;
      middle += m_distance[m->second] / n;
      spacing += m_scan.local_spacing[m->second] / n;
    }
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    Vec3 rise = Vec3::Zero();
    for (const Member* m = begin; m != end; ++m) {
      const Vec3 d = m_scan.points[m->second] - mean;
      covariance += d * d.transpose();
      rise += (m_distance[m->second] - middle) * d;
    }
    covariance += 1e-3 * covariance.trace() * Eigen::Matrix3d::Identity();
    Vec3 along;
    if (!linear_algebra::solve_symmetric(covariance, rise, along) || !(along.squaredNorm() > 0))
      return false;
    const Vec3 e1 = along.normalized().unitOrthogonal(), e2 = along.normalized().cross(e1);
    std::vector<Vec2> plane;
    for (const Member* m = begin; m != end; ++m) {
      const Vec3 d = m_scan.points[m->second] - mean;
      plane.emplace_back(d.dot(e1), d.dot(e2));
    }
    const Circle circle = fit_circle(plane);
    return circle.radius > m_rules.radius * spacing &&
           circle.deviation < m_rules.band * circle.radius &&
           covered_sectors(plane, circle.center) >= m_rules.sectors;
  }

  const Scan& m_scan;
  const std::vector<double>& m_distance;
  const std::vector<Index>& m_layer;
  Sparse_layer_options m_rules;
  std::vector<std::uint8_t> m_level; ///< required doublings at each point
};

} // namespace internal

/*!
  Joins the components of sparse level sets. The thickness of level sets follows the typical
  spacing; where the points of a thick stem are farther apart, level sets fall into several
  components. There, the thickness is doubled until the components are connected, provided that they
  form rings. Twigs with single rows of points remain unchanged. `layer` is the level set of each
  point, `sets` has the level-set components. O(links + p log p) with p points in sparse level sets.
*/
template <class ConcurrencyTag, class LinkRange>
void join_sparse_layers(const Scan& scan,
                        const LinkRange& links,
                        const std::vector<double>& distance,
                        const std::vector<Index>& layer,
                        double thickness,
                        const Sparse_layer_options& rules,
                        Point_sets& sets)
{
  std::vector<std::uint8_t> level =
      internal::doublings_of_layers<ConcurrencyTag>(scan, layer, thickness, rules);
  internal::Sparse_layer_joiner(scan, distance, layer, rules, std::move(level)).run(links, sets);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_JOIN_SPARSE_LAYERS_H
