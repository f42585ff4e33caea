// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of Point_instances.h.

#ifndef PCS_SHAPE_SPACE_POINTS_POINT_INSTANCES_IMPL_H
#define PCS_SHAPE_SPACE_POINTS_POINT_INSTANCES_IMPL_H

#include <pcs/internal/constants.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/points/Point_instances.h>
#include <pcs/shape_space/points/flat_sections.h>
#include <pcs/shape_space/points/tube_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

template <class ConcurrencyTag>
void Point_instances::set(const Orl_layout& layout,
                          const std::array<Orl_geometry, 2>& geometry,
                          const std::array<std::vector<Vec3>, 2>& points,
                          const std::array<std::vector<Vec3>, 2>& normals,
                          std::vector<char> is_relative,
                          std::vector<Point_pair> pairs,
                          ConcurrencyTag)
{
  m_pairs = std::move(pairs);
  m_is_relative = std::move(is_relative);
  const std::size_t n = layout.number_of_edges();
  m_first.assign(n + 1, 0);
  for (const Point_pair& p : m_pairs)
    ++m_first[p.edge + 1];
  for (std::size_t e = 0; e < n; ++e)
    m_first[e + 1] += m_first[e];
  m_branch_of.resize(n);
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
      m_branch_of[layout.branches[b].first_edge + j] = static_cast<std::uint32_t>(b);
  m_is_flat.assign(n, 0);
  m_thin_angle.assign(n, {0, 0});
  m_lines.resize(m_pairs.size());
  m_has_normals = normals[0].size() == points[0].size() && normals[1].size() == points[1].size() &&
                  !(points[0].empty() && points[1].empty());
  m_normals.resize(m_has_normals ? m_pairs.size() : 0);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t e) {
        if (m_first[e] == m_first[e + 1])
          return;
        const std::array<Edge_cone, 2> cone = {edge_cone(layout, geometry[0], m_branch_of[e], e),
                                               edge_cone(layout, geometry[1], m_branch_of[e], e)};
        m_is_relative[e] = m_is_relative[e] && are_near(e, cone, points) ? 1 : 0;
        m_is_flat[e] = !m_is_relative[e] && find_flat(e, cone, points) ? 1 : 0;
        for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k)
          set_pair(k, cone, points, normals);
      },
      64);
}

inline bool Point_instances::are_near(std::size_t e,
                                      const std::array<Edge_cone, 2>& cone,
                                      const std::array<std::vector<Vec3>, 2>& points) const
{
  constexpr double farthest = 2; // in radii
  for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k)
    for (std::size_t t = 0; t < 2; ++t)
      if (m_pairs[k].point[t] != no_point) {
        const Tube_coordinates c = tube_coordinates(cone[t], points[t][m_pairs[k].point[t]], true);
        if (!(c.distance <= farthest) || !(std::abs(c.overshoot) <= farthest))
          return false;
      }
  return true;
}

inline bool Point_instances::find_flat(std::size_t e,
                                       const std::array<Edge_cone, 2>& cone,
                                       const std::array<std::vector<Vec3>, 2>& points)
{
  std::array<double, 2>& angle = m_thin_angle[e];
  for (std::size_t t = 0; t < 2; ++t) {
    std::vector<Vec3> own;
    for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k)
      if (m_pairs[k].point[t] != no_point)
        own.push_back(points[t][m_pairs[k].point[t]]);
    const Section section = section_across(cone[t], own);
    if (!section.is_flat())
      return false;
    angle[t] = std::atan2(section.axis.x(), -section.axis.y());
  }
  angle[1] = angle[0] + std::remainder(angle[1] - angle[0], pcs::internal::pi); // without a sign
  return true;
}

inline void Point_instances::set_pair(std::size_t k,
                                      const std::array<Edge_cone, 2>& cone,
                                      const std::array<std::vector<Vec3>, 2>& points,
                                      const std::array<std::vector<Vec3>, 2>& normals)
{
  const Point_pair& pair = m_pairs[k];
  std::array<Tube_coordinates, 2> c{};
  std::array<Vec3, 2> normal{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t t = 0; t < 2; ++t)
    if (pair.point[t] != no_point) {
      c[t] = tube_coordinates(cone[t], points[t][pair.point[t]], is_relative(pair.edge));
      const double rotation = m_is_flat[pair.edge] ? 0 : c[t].angle;
      if (m_has_normals)
        normal[t] =
            turn_about_z(-rotation) * (cone[t].frame.transpose() * normals[t][pair.point[t]]);
    }
  for (std::size_t t = 0; t < 2; ++t)
    if (pair.point[t] == no_point) {
      c[t] = c[1 - t];
      if (!is_relative(pair.edge)) { // the copy shrinks with the branch
        const double here = cone[t].radius(c[t].t), there = cone[1 - t].radius(c[t].t);
        const double f = !(cone[t].length > 0) ? 0 : there > 0 ? std::min(1.0, here / there) : 1;
        c[t].distance *= f;
        c[t].overshoot *= f;
      }
      normal[t] = normal[1 - t];
    }
  double change = std::remainder(c[1].angle - c[0].angle, 2 * pcs::internal::pi);
  if (m_is_flat[pair.edge]) {
    for (Tube_coordinates& own : c) {
      const double x = own.distance * std::cos(own.angle);
      own.distance *= std::sin(own.angle);
      own.angle = x;
    }
    change = c[1].angle - c[0].angle;
  }
  m_lines[k] = {c[0].t,
                c[1].t - c[0].t,
                c[0].overshoot,
                c[1].overshoot - c[0].overshoot,
                c[0].angle,
                change,
                c[0].distance,
                c[1].distance - c[0].distance};
  if (m_has_normals)
    m_normals[k] = normal;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_POINT_INSTANCES_IMPL_H
