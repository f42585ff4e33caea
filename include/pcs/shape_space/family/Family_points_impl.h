// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Family_points.h.

#ifndef PCS_SHAPE_SPACE_FAMILY_FAMILY_POINTS_IMPL_H
#define PCS_SHAPE_SPACE_FAMILY_FAMILY_POINTS_IMPL_H

#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/family/Family_points.h>
#include <pcs/shape_space/points/tube_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace shape_space {

/// Chooses, for every branch, the points of the scan with the most points there, or of a preferred
/// scan, sorted by edge. `edge[t][i]`: edge of point i of scan t, or `none` if it is left out.
/// `preferred`: a scan, or `none`.
inline std::vector<Family_source> choose_points(const Orl_layout& layout,
                                                const std::vector<std::vector<std::size_t>>& edge,
                                                std::size_t preferred)
{
  const std::size_t n = layout.number_of_edges(), m = layout.branches.size();
  std::vector<std::size_t> branch_of(n);
  for (std::size_t b = 0; b < m; ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
      branch_of[layout.branches[b].first_edge + j] = b;
  std::vector<std::size_t> source(m, none), most(m, 0);
  std::vector<char> is_settled(m, 0);
  for (std::size_t t = 0; t < edge.size(); ++t) {
    std::vector<std::size_t> count(m, 0);
    for (const std::size_t e : edge[t])
      if (e != none)
        ++count[branch_of[e]];
    for (std::size_t b = 0; b < m; ++b)
      if (count[b] > 0 && (t == preferred || (count[b] > most[b] && !is_settled[b]))) {
        source[b] = t;
        most[b] = count[b];
        is_settled[b] = t == preferred;
      }
  }
  std::vector<Family_source> result;
  for (std::size_t t = 0; t < edge.size(); ++t)
    for (std::size_t i = 0; i < edge[t].size(); ++i)
      if (edge[t][i] != none && source[branch_of[edge[t][i]]] == t)
        result.push_back({static_cast<std::uint32_t>(t),
                          static_cast<std::uint32_t>(i),
                          static_cast<std::uint32_t>(edge[t][i])});
  std::stable_sort(result.begin(),
                   result.end(),
                   [](const Family_source& a, const Family_source& b) { return a.edge < b.edge; });
  return result;
}

template <class ConcurrencyTag>
void Family_points::set(const Orl_layout& layout,
                        const std::vector<Orl_geometry>& geometry,
                        const std::vector<Point>& points,
                        const std::vector<Partner>& partners,
                        bool has_normals,
                        ConcurrencyTag)
{
  const std::size_t n = layout.number_of_edges();
  m_first.assign(n + 1, 0);
  m_source.clear();
  for (const Point& p : points) {
    m_source.push_back({p.tree, p.index, p.edge});
    ++m_first[p.edge + 1];
  }
  for (std::size_t e = 0; e < n; ++e)
    m_first[e + 1] += m_first[e];
  m_first_partner.assign(points.size() + 1, 0);
  for (const Partner& p : partners)
    ++m_first_partner[p.point + 1];
  for (std::size_t k = 0; k < points.size(); ++k)
    m_first_partner[k + 1] += m_first_partner[k];
  m_branch_of.resize(n);
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
      m_branch_of[layout.branches[b].first_edge + j] = b;
  m_has_normals = has_normals && !points.empty();
  m_coordinates.resize(points.size());
  m_normal.resize(m_has_normals ? points.size() : 0);
  m_partner.resize(partners.size());
  m_normal_difference.resize(m_has_normals ? partners.size() : 0);
  m_is_relative.assign(n, 0);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t e) {
        if (m_first[e] < m_first[e + 1])
          set_edge(layout, geometry, points, partners, e);
      },
      64);
}

inline void Family_points::set_edge(const Orl_layout& layout,
                                    const std::vector<Orl_geometry>& geometry,
                                    const std::vector<Point>& points,
                                    const std::vector<Partner>& partners,
                                    std::size_t e)
{
  std::vector<Edge_cone> cone;
  for (const Orl_geometry& g : geometry)
    cone.push_back(edge_cone(layout, g, m_branch_of[e], e));
  bool is_relative = true;
  for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k) {
    is_relative = is_relative && is_near(cone[points[k].tree], position_of(points[k]));
    for (std::size_t j = m_first_partner[k]; j < m_first_partner[k + 1]; ++j)
      is_relative = is_relative && is_near(cone[partners[j].tree], position_of(partners[j]));
  }
  m_is_relative[e] = is_relative;
  for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k) {
    const Edge_cone& own = cone[points[k].tree];
    const Tube_coordinates p = m_coordinates[k] =
        tube_coordinates(own, position_of(points[k]), is_relative);
    if (m_has_normals)
      m_normal[k] = local_normal(own, points[k].normal, p.angle);
    for (std::size_t j = m_first_partner[k]; j < m_first_partner[k + 1]; ++j) {
      const Edge_cone& other = cone[partners[j].tree];
      const Tube_coordinates q = tube_coordinates(other, position_of(partners[j]), is_relative);
      constexpr double whole = 2 * pcs::internal::pi;
      m_partner[j] = {partners[j].tree,
                      partners[j].index,
                      static_cast<float>(q.t - p.t),
                      static_cast<float>(q.overshoot - p.overshoot),
                      static_cast<float>(std::remainder(q.angle - p.angle, whole)),
                      static_cast<float>(q.distance - p.distance)};
      if (m_has_normals)
        m_normal_difference[j] =
            (local_normal(other, partners[j].normal, q.angle) - m_normal[k]).cast<float>();
    }
  }
}

inline Vec3
Family_points::local_normal(const Edge_cone& cone, const std::array<double, 3>& v, double angle)
{
  return around(cone.frame.transpose() * Vec3(v[0], v[1], v[2]), -std::sin(angle), std::cos(angle));
}

inline bool Family_points::is_near(const Edge_cone& cone, const Vec3& position)
{
  constexpr double farthest = 2; // in radii
  if (!(std::min(cone.from_radius, cone.to_radius) >
        1e-3 * std::max(cone.from_radius, cone.to_radius)))
    return false;
  const Tube_coordinates c = tube_coordinates(cone, position, true);
  return c.distance <= farthest && std::abs(c.overshoot) <= farthest;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_FAMILY_POINTS_IMPL_H
