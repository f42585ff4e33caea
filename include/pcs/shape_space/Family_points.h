// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The points of a family of trees: each branch carries those of one scan, whatever becomes of it.

#ifndef PCS_SHAPE_SPACE_FAMILY_POINTS_H
#define PCS_SHAPE_SPACE_FAMILY_POINTS_H

#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/tube_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace shape_space {

/// A point of a scan, and the edge of the topology it lies on.
struct Family_source
{
  std::uint32_t tree, point, edge;
};

/*!
  Points in tube coordinates of the tree that they were scanned on, by edge: of every branch those of the scan that has
  most points there, or of a preferred scan. Their order is the same for all trees.
*/
class Family_points
{
public:
  std::size_t size() const { return m_source.size(); }
  const std::vector<Family_source>& sources() const { return m_source; }
  const std::vector<std::size_t>& first() const { return m_first; }
  bool has_normals() const { return m_has_normals; }

  /// `edge[t][i]`: of point i of scan t, `none`: left out. `preferred`: a scan, or `none`.
  static std::vector<Family_source> choose(const Orl_layout& layout,
                                           const std::vector<std::vector<std::size_t>>& edge,
                                           std::size_t preferred)
  {
    const std::size_t n = layout.number_of_edges();
    std::vector<std::size_t> branch_of(n);
    for (std::size_t b = 0; b < layout.branches.size(); ++b)
      for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
        branch_of[layout.branches[b].first_edge + j] = b;
    std::vector<std::size_t> carrier(layout.branches.size(), none), most(layout.branches.size(), 0);
    std::vector<char> is_settled(layout.branches.size(), 0);
    for (std::size_t t = 0; t < edge.size(); ++t) {
      std::vector<std::size_t> count(layout.branches.size(), 0);
      for (const std::size_t e : edge[t])
        if (e != none)
          ++count[branch_of[e]];
      for (std::size_t b = 0; b < count.size(); ++b)
        if (count[b] > 0 && (t == preferred || (count[b] > most[b] && !is_settled[b]))) {
          carrier[b] = t;
          most[b] = count[b];
          is_settled[b] = t == preferred;
        }
    }
    std::vector<Family_source> result;
    for (std::size_t t = 0; t < edge.size(); ++t)
      for (std::size_t i = 0; i < edge[t].size(); ++i)
        if (edge[t][i] != none && carrier[branch_of[edge[t][i]]] == t)
          result.push_back({static_cast<std::uint32_t>(t),
                            static_cast<std::uint32_t>(i),
                            static_cast<std::uint32_t>(edge[t][i])});
    std::stable_sort(
        result.begin(),
        result.end(),
        [](const Family_source& a, const Family_source& b) { return a.edge < b.edge; });
    return result;
  }

  /// Points by edge, in the coordinates of the space; `geometry[t]`: of the tree with scan t.
  template <class ConcurrencyTag>
  void set(const Orl_layout& layout,
           const std::vector<Orl_geometry>& geometry,
           const std::vector<Orl_space_data::Point>& points,
           bool has_normals,
           ConcurrencyTag)
  {
    const std::size_t n = layout.number_of_edges();
    m_first.assign(n + 1, 0);
    m_source.clear();
    for (const Orl_space_data::Point& p : points) {
      m_source.push_back({p.tree, p.index, p.edge});
      ++m_first[p.edge + 1];
    }
    for (std::size_t e = 0; e < n; ++e)
      m_first[e + 1] += m_first[e];
    m_branch_of.resize(n);
    for (std::size_t b = 0; b < layout.branches.size(); ++b)
      for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
        m_branch_of[layout.branches[b].first_edge + j] = b;
    m_has_normals = has_normals && !points.empty();
    m_place.resize(points.size());
    m_normal.resize(m_has_normals ? points.size() : 0);
    m_is_relative.assign(n, 0);
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t e) {
          if (m_first[e] == m_first[e + 1])
            return;
          const Edge_cone cone =
              edge_cone(layout, geometry[points[m_first[e]].tree], m_branch_of[e], e);
          const auto position = [&](std::size_t k) {
            const auto& p = points[k].position;
            return Vec3(p[0], p[1], p[2]);
          };
          m_is_relative[e] = is_near(cone, e, position) ? 1 : 0;
          for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k) {
            const Tube_coordinates c = tube_coordinates(cone, position(k), m_is_relative[e] != 0);
            m_place[k] = {c.distance * std::cos(c.angle),
                          c.distance * std::sin(c.angle),
                          c.t,
                          c.overshoot};
            const auto& v = points[k].normal;
            if (m_has_normals)
              m_normal[k] = cone.frame.transpose() * Vec3(v[0], v[1], v[2]);
          }
        },
        64);
  }

  /// Calls `put(i, point, normal, k)` for all points of a tree: `i` counts those of branches that it has, `k` all.
  template <class ConcurrencyTag, class Put>
  void write(const Orl_layout& layout,
             const Orl_coordinates& x,
             const Orl_geometry& geometry,
             const std::vector<std::size_t>& offset,
             const Put& put,
             ConcurrencyTag) const
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        layout.number_of_edges(),
        [&](std::size_t e) {
          if (!(x.length[e] > 0) || m_first[e] == m_first[e + 1])
            return;
          const Edge_cone cone = edge_cone(layout, geometry, m_branch_of[e], e);
          std::size_t i = offset[e];
          for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k, ++i) {
            const Place& p = m_place[k];
            const double unit = m_is_relative[e] ? cone.radius(p.t) : 1;
            const Vec3 local(unit * p.x, unit * p.y, p.t * cone.length + unit * p.overshoot);
            put(i,
                Vec3(cone.from + cone.frame * local),
                m_has_normals ? Vec3(cone.frame * m_normal[k]) : Vec3(Vec3::Zero()),
                k);
          }
        },
        64);
  }

private:
  /// Off the axis and beyond the ends in radii, or in units of length; along the edge as a share.
  struct Place
  {
    double x, y, t, overshoot;
  };

  /// Whether the radius is known and no point is so far off that a thicker branch must not carry it further.
  template <class Position>
  bool is_near(const Edge_cone& cone, std::size_t e, const Position& position) const
  {
    constexpr double farthest = 2; // radii
    if (!(std::min(cone.from_radius, cone.to_radius) >
          1e-3 * std::max(cone.from_radius, cone.to_radius)))
      return false;
    for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k) {
      const Tube_coordinates c = tube_coordinates(cone, position(k), true);
      if (!(c.distance <= farthest) || !(std::abs(c.overshoot) <= farthest))
        return false;
    }
    return true;
  }

  std::vector<Family_source> m_source; // by edge
  std::vector<std::size_t> m_first, m_branch_of;
  std::vector<char> m_is_relative;
  std::vector<Place> m_place;
  std::vector<Vec3> m_normal; // in the frame of the edge
  bool m_has_normals = false;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_POINTS_H
