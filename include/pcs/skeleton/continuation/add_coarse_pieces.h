// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Places where the axes of a scan miss thick wood that an axis of the thinned scan explains.

#ifndef PCS_SKELETON_CONTINUATION_ADD_COARSE_PIECES_H
#define PCS_SKELETON_CONTINUATION_ADD_COARSE_PIECES_H

#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/continuation/Held_axes.h>
#include <pcs/skeleton/continuation/find_coarse_axes.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// The points near a coarse axis, compared with its surface.
class Coarse_surface
{
public:
  /// Keeps references to `scan`, `axis` and `rules`. `width(r)`: half thickness of the surface at
  /// the radius `r` [L].
  template <class Width>
  Coarse_surface(const Scan& scan,
                 const std::vector<std::uint8_t>& is_used,
                 const Coarse_axis& coarse,
                 const Coarse_axis_options& rules,
                 const Width& width,
                 const Held_axes& fine)
    : m_scan(scan),
      m_coarse(coarse),
      m_rules(rules),
      m_compared(coarse.axis.size(), 0),
      m_on(m_compared),
      m_known(m_compared)
  {
    const Axis& axis = coarse.axis;
    const auto reach = [&](std::size_t k) { // 0: the node is not credible
      const double length = k + 1 < axis.size() ? (axis[k + 1].point - axis[k].point).norm() : 0;
      return axis[k].radius >= coarse.thinnest ? rules.reach * axis[k].radius + length : 0;
    };
    const Axis_projector project(axis);
    Axis_place place;
    for (const Index i : points_near(scan, axis, reach)) {
      place = project(place.segment, scan.points[i]);
      const double r = radius_at(axis, place);
      if (place.share < 0 || place.share > 1 || place.distance > rules.reach * r || !is_used[i])
        continue;
      ++m_compared[place.segment];
      if (std::abs(place.distance - r) > width(r))
        continue;
      ++m_on[place.segment];
      m_known[place.segment] += fine.is_similar(i, r);
      m_points.push_back({i, place});
    }
  }

  /// Returns whether a segment lies on thick wood that the fine axes miss.
  bool is_missed(std::size_t segment) const
  {
    double compared = 0, on = 0, known = 0;
    const std::size_t end = std::min(m_on.size(), segment + 2);
    for (std::size_t k = segment - std::min<std::size_t>(segment, 1); k < end; ++k) {
      compared += m_compared[k];
      on += m_on[k];
      known += m_known[k];
    }
    return m_coarse.axis[segment].radius >= m_coarse.thinnest && on >= double(m_rules.fewest) &&
           on > m_rules.on_surface * compared && known < m_rules.known * on;
  }

  /// Returns whether the points on the surface surround the segments in `[begin, end)`, compared
  /// with random points.
  bool is_surrounded(std::size_t begin, std::size_t end, double share) const
  {
    const Axis& axis = m_coarse.axis;
    const Vec3 along = (axis[end].point - axis[begin].point).normalized();
    const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    std::vector<Vec2> across;
    for (const Point& p : m_points)
      if (p.place.segment >= begin && p.place.segment < end) {
        const Vec3 v = m_scan.points[p.index] - point_at(axis, p.place);
        across.emplace_back(v.dot(e1), v.dot(e2));
      }
    return !across.empty() &&
           covered_sectors(across, Vec2(0, 0)) >= share * sectors_of_random_points(across.size());
  }

private:
  struct Point
  {
    Index index;
    Axis_place place;
  };

  const Scan& m_scan;
  const Coarse_axis& m_coarse;
  const Coarse_axis_options& m_rules;
  std::vector<double> m_compared, m_on, m_known; ///< points of each segment [count]
  std::vector<Point> m_points;                   ///< on the surface
};

} // namespace internal

/*!
  Adds the pieces of a coarse axis to `fine`, as axes that are not held, where the fine axes miss
  thick wood. They take the points of the strands along its surface. Returns their number.

  Points of `is_used` at the distance `d <= reach r` [L] from the coarse axis, which has the radius
  `r` [L] there, are compared with its surface. They lie on it if

      |d - r| <= max(filled_noise s, cover_factor r)

  (`Chain_options`) with the noise `s` [L]. Segments of at least the radius `thinnest` belong to a
  piece if, together with the adjacent ones, they have at least `fewest` points on the surface, if
  these are more than the fraction `on_surface` of the compared ones, and if axes of similar radius
  explain less than the fraction `known` of these. A bundle of twigs has points inside and outside.
  A piece is at least `shortest r` long, and its points surround it (`Thick_continuation`): those of
  a stem that is seen from one side also lie on much thicker tubes. O(p log p) for p points near the
  axis.
*/
inline std::size_t add_coarse_pieces(const Scan& scan,
                                     const std::vector<std::uint8_t>& is_used,
                                     const Coarse_axis& coarse,
                                     double noise,
                                     const Chain_options& chains,
                                     const Coarse_axis_options& rules,
                                     Held_axes& fine)
{
  const auto width = [&](double r) {
    return std::max(chains.filled_noise * noise, chains.cover_factor * r);
  };
  const internal::Coarse_surface surface(scan, is_used, coarse, rules, width, fine);
  std::vector<Axis> pieces;
  const Axis& axis = coarse.axis;
  for (std::size_t begin = 0; begin + 1 < axis.size();) {
    std::size_t end = begin;
    while (end + 1 < axis.size() && surface.is_missed(end))
      ++end;
    if (end > begin) {
      Axis piece(axis.begin() + static_cast<std::ptrdiff_t>(begin),
                 axis.begin() + static_cast<std::ptrdiff_t>(end) + 1);
      if (length_of(piece) >= rules.shortest * piece.front().radius &&
          surface.is_surrounded(begin, end, fine.rules().sectors))
        pieces.push_back(std::move(piece));
    }
    begin = end + 1;
  }
  for (Axis& piece : pieces)
    fine.add(none, std::move(piece));
  return pieces.size();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_ADD_COARSE_PIECES_H
