// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Thick axes, and which of them similar wood connects to the root.

#ifndef PCS_SKELETON_CONTINUATION_HELD_AXES_H
#define PCS_SKELETON_CONTINUATION_HELD_AXES_H

#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/axes/remove_axes.h>
#include <pcs/skeleton/continuation/Thick_continuation.h>
#include <pcs/skeleton/continuation/thick_line.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  The thick axes of a set. An axis is held if its base lies at the root or on a held axis of similar
  thickness, so that wood of similar thickness connects it to the root. Loose axes thus never hold
  each other, as two branches beyond a gap below their fork.

  An axis takes over points of thinner and of much smaller axes, but none of held thick ones.
*/
class Held_axes
{
public:
  /// Base of an axis, and a ball around the whole axis.
  struct Base
  {
    Axis_node node;
    Vec3 along;        ///< direction beyond the base
    Vec3 center;       ///< of the ball
    double extent = 0; ///< radius of the ball [L]
  };

  /// Keeps references to all arguments. `is_free`: points that a continuation may explain; `root`:
  /// points of the root.
  Held_axes(const Scan& scan,
            const std::vector<std::uint8_t>& is_free,
            const Chain_options& chains,
            const Thick_end_options& rules,
            const std::vector<Index>& root,
            Axis_set& set)
    : m_scan(scan),
      m_is_free(is_free),
      m_chains(chains),
      m_rules(rules),
      m_root(root),
      m_set(set),
      m_thinnest(rules.least_radius(scan.spacing, set.noise)),
      m_lost(set.axes.size(), 0),
      m_points(set.axes.size()),
      m_is_held(set.axes.size(), 0),
      m_bases(set.axes.size())
  {
    for (Index i = 0; i < scan.size(); ++i)
      if (set.is_covered(i))
        m_points[set.axis_of_point[i]].push_back(i);
    find_thick_axes();
    for (const Index a : m_thick) {
      measure(a);
      m_is_held[a] = is_at_root(a);
    }
    hold_more();
  }

  const Thick_end_options& rules() const { return m_rules; }
  const std::vector<Fitted_axis>& axes() const { return m_set.axes; }
  /// Returns the axes that may have thick bases: first those of the set, thickest first, then the
  /// added ones.
  const std::vector<Index>& thick() const { return m_thick; }
  bool is_held(Index a) const { return m_is_held[a] != 0; }

  /// Returns a continuation of lines through the points of the scan.
  Thick_continuation continuation() const
  {
    return Thick_continuation(m_scan, m_set.noise, m_chains, m_rules);
  }
  Thick_line line_to_base(Index a) const
  {
    return skeleton::line_to_base(m_set.axes[a].axis, m_thinnest, m_chains, m_rules);
  }
  Vec3 direction_of(const Axis& line) const
  {
    return Thick_line::direction_of(line, m_rules.piece * line.back().radius);
  }

  /// Holds axis `a`, and all axes whose bases lie on held axes.
  void hold(Index a)
  {
    m_is_held[a] = 1;
    hold_more();
  }
  /// From now on, axes beyond short gaps are held, too.
  void leave_gaps()
  {
    m_may_leave_gaps = true;
    hold_more();
  }

  /// Returns whether the end of axis `a` lies on a held axis of similar thickness, or, if
  /// gaps may be left, is separated from it by a short one along the direction `along`.
  bool is_on_held(Index a, const Axis_node& end, const Vec3& along) const
  {
    return std::any_of(m_thick.begin(), m_thick.end(), [&](Index b) {
      if (b == a || !is_held_within(b, end, m_rules.least))
        return false;
      const Axis& axis = m_set.axes[b].axis;
      const Axis_place place = nearest_place(axis, end.point);
      const double radius = radius_at(axis, place), gap = place.distance - radius;
      const Vec3 d = point_at(axis, place) - end.point;
      return radius >= m_rules.touched * end.radius &&
             (gap < m_rules.touch * end.radius ||
              (m_may_leave_gaps && gap < m_rules.least * end.radius && is_ahead(d, along)));
    });
  }
  /// Returns whether an axis explains the point `i` that is not much thinner than `radius` [L].
  bool is_similar(Index i, double radius) const
  {
    return m_set.is_covered(i) && radius_of(i) >= m_rules.touched * radius;
  }
  /// Returns the nodes of held axes at which a tube may end, about one per radius.
  std::vector<Thick_target> targets_ahead(const Axis_node& end, const Vec3& along) const
  {
    std::vector<Thick_target> targets;
    const double longest = m_rules.longest * end.radius;
    for (const Index b : m_thick) {
      if (!is_held_within(b, end, m_rules.longest))
        continue;
      const Axis& axis = m_set.axes[b].axis;
      double since = std::numeric_limits<double>::infinity(); // last target [L]
      for (std::size_t k = 0; k < axis.size(); ++k) {
        since += k > 0 ? (axis[k].point - axis[k - 1].point).norm() : 0;
        const Vec3 d = axis[k].point - end.point;
        if ((since < end.radius && k + 1 < axis.size()) || d.norm() > longest ||
            axis[k].radius < m_rules.touched * end.radius || !is_ahead(d, along))
          continue;
        since = 0;
        targets.push_back({axis[k].point, axis[k].radius});
      }
    }
    return targets;
  }

  /// Returns the points within a distance of the end of a line that its continuation may explain.
  std::vector<Index>
  free_points(Index a, const Thick_line& line, const Axis_node& end, double distance) const
  {
    std::vector<Index> near;
    m_scan.search->append_within(end.point, distance, near);
    const auto is_taken = [&](Index i) {
      const bool is_rest = m_set.axis_of_point[i] == a &&
                           m_set.segment_of_point[i] >= line.rest_begin &&
                           m_set.segment_of_point[i] < line.rest_end;
      return is_rest || !m_is_free[i] || !may_take(i, a, end.radius);
    };
    near.erase(std::remove_if(near.begin(), near.end(), is_taken), near.end());
    return near;
  }

  /// Returns the number of unexplained points around bases that are not held, and have no held axis
  /// of similar thickness near them [count]. Bases with fewer than `fewest` of them do not count.
  std::size_t count_unexplained() const
  {
    std::vector<std::uint8_t> is_marked(m_scan.size(), 0);
    for (const Index a : m_thick)
      if (!m_is_held[a])
        mark_unexplained(a, is_marked);
    return static_cast<std::size_t>(std::count(is_marked.begin(), is_marked.end(), 1));
  }

  /// Replaces the nodes of axis `a`, and assigns to it the points on its surface. `meeting`: see
  /// `Fitted_axis`.
  void replace(Index a, Axis nodes, std::size_t meeting)
  {
    m_set.axes[a].axis = std::move(nodes);
    m_set.axes[a].meeting = meeting;
    const Axis& axis = m_set.axes[a].axis;
    std::vector<Index> points;
    const Axis_projector project(axis);
    Axis_place place;
    for (const Index i : points_near(a)) {
      place = project(place.segment, m_scan.points[i]);
      const double r = radius_at(axis, place);
      if (!may_take(i, a, r))
        continue;
      Index& owner = m_set.axis_of_point[i];
      const bool is_on = place.share >= 0 && place.share <= 1 && place.distance <= r + cover(r);
      if (!is_on) {
        if (owner == a)
          owner = m_set.segment_of_point[i] = none;
        continue;
      }
      if (owner != none && owner != a) {
        ++m_lost[owner];
        --m_set.axes[owner].number_of_points;
      }
      owner = a;
      m_set.segment_of_point[i] = place.segment;
      points.push_back(i);
    }
    m_set.axes[a].number_of_points = points.size();
    m_points[a] = std::move(points);
    measure(a);
  }
  /// Adds an axis that is not held.
  void add(Index parent, Axis nodes)
  {
    const Index b = static_cast<Index>(m_set.axes.size());
    m_set.axes.emplace_back();
    m_set.axes[b].parent = parent;
    m_lost.push_back(0);
    m_points.emplace_back();
    m_is_held.push_back(0);
    m_bases.emplace_back();
    m_thick.push_back(b);
    replace(b, std::move(nodes), 0);
    m_lost[b] += m_set.axes[b].number_of_points == 0; // `drop_lost()` removes it
  }
  /// Drops the axes that lost most of their points. Afterwards, this object is of no use.
  void drop_lost()
  {
    remove_axes(
        [&](Index a) {
          const std::size_t left = m_set.axes[a].number_of_points;
          return m_lost[a] > 0 && (double(m_lost[a]) > m_rules.lost * double(left + m_lost[a]) ||
                                   left < m_chains.lowest_count);
        },
        m_set);
  }

private:
  void find_thick_axes()
  {
    std::vector<std::pair<double, Index>> thick; // negative radius, axis
    for (Index a = 0; a < m_set.axes.size(); ++a) {
      double radius = 0;
      for (const Axis_node& node : m_set.axes[a].axis)
        radius = std::max(radius, node.radius);
      if (radius >= m_thinnest)
        thick.emplace_back(-radius, a);
    }
    std::sort(thick.begin(), thick.end());
    for (const auto& t : thick)
      m_thick.push_back(t.second);
  }
  void measure(Index a)
  {
    const Axis& axis = m_set.axes[a].axis;
    Axis line = line_to_base(a).nodes;
    if (line.empty())
      line.assign(axis.rbegin(), axis.rend());
    Base& base = m_bases[a];
    base.node = line.back();
    base.along = direction_of(line);
    base.center = 0.5 * (axis.front().point + axis.back().point);
    base.extent = 0;
    for (const Axis_node& node : axis)
      base.extent = std::max(base.extent, (node.point - base.center).norm() + node.radius);
  }

  bool is_at_root(Index a) const
  {
    const Axis& axis = m_set.axes[a].axis;
    return std::any_of(m_root.begin(), m_root.end(), [&](Index i) {
      const Axis_place place = nearest_place(axis, m_scan.points[i]);
      return place.distance < m_rules.at_root * radius_at(axis, place);
    });
  }
  void hold_more()
  {
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      for (const Index a : m_thick)
        if (!m_is_held[a] && is_base_held(a)) {
          m_is_held[a] = 1;
          is_changed = true;
        }
    }
  }
  bool is_base_held(Index a) const
  {
    const Base& base = m_bases[a];
    const Axis_node& front = m_set.axes[a].axis.front();
    return is_on_held(a, base.node, base.along) ||
           (front.radius > m_rules.touched * base.node.radius && is_on_held(a, front, base.along));
  }
  bool is_held_within(Index b, const Axis_node& end, double radii) const
  {
    const double reach = m_bases[b].extent + radii * end.radius;
    return m_is_held[b] && (m_bases[b].center - end.point).squaredNorm() <= reach * reach;
  }
  bool is_ahead(const Vec3& d, const Vec3& along) const
  {
    return d.dot(along) > std::cos(m_rules.widest_turn) * d.norm();
  }

  double radius_of(Index i) const
  {
    return m_set.axes[m_set.axis_of_point[i]].axis[m_set.segment_of_point[i]].radius;
  }
  bool is_small(Index b, Index a) const
  {
    return double(m_set.axes[b].number_of_points) <
           m_rules.small * double(m_set.axes[a].number_of_points);
  }
  /// Returns whether axis `a` may explain the point `i`. `radius`: of axis `a` near the point [L].
  bool may_take(Index i, Index a, double radius) const
  {
    const Index b = m_set.axis_of_point[i];
    if (m_scan.is_outlier[i])
      return false;
    if (b == none || b == a)
      return true;
    if (m_is_held[b] && radius_of(i) >= m_thinnest)
      return false;
    return radius_of(i) < m_rules.released * radius || is_small(b, a);
  }
  /// Marks the unexplained points around the base of axis `a` if no held axis of similar thickness
  /// is near: a part of a thick branch is missing there.
  void mark_unexplained(Index a, std::vector<std::uint8_t>& is_marked) const
  {
    const Thick_line line = line_to_base(a);
    if (line.nodes.empty())
      return;
    const Axis_node& end = line.nodes.back();
    std::vector<Index> near, open;
    m_scan.search->append_within(end.point, m_rules.loose * end.radius, near);
    for (const Index i : near)
      if (!m_set.is_covered(i)) {
        if (!m_scan.is_outlier[i])
          open.push_back(i);
      } else if (m_is_held[m_set.axis_of_point[i]] && radius_of(i) >= m_rules.touched * end.radius)
        return;
    if (open.size() >= m_rules.fewest)
      for (const Index i : open)
        is_marked[i] = 1;
  }

  /// Returns the largest distance from the surface of explained points outside it [L].
  double cover(double radius) const
  {
    return std::max(m_chains.cover_offset * m_scan.spacing, m_chains.cover_factor * radius);
  }
  /// Returns the points that axis `a` explains, and those near it.
  std::vector<Index> points_near(Index a) const
  {
    const Axis& axis = m_set.axes[a].axis;
    const auto reach = [&](std::size_t k) {
      if (k + 1 == axis.size())
        return 0.0;
      const double length = (axis[k + 1].point - axis[k].point).norm();
      const double r = std::max(axis[k].radius, axis[k + 1].radius);
      return length + r + cover(r);
    };
    return skeleton::points_near(m_scan, axis, reach, m_points[a]);
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_free;
  const Chain_options& m_chains;
  const Thick_end_options& m_rules;
  const std::vector<Index>& m_root;
  Axis_set& m_set;
  double m_thinnest;                        ///< least radius of a thick base [L]
  std::vector<std::size_t> m_lost;          ///< points taken from each axis [count]
  std::vector<std::vector<Index>> m_points; ///< of each axis
  std::vector<Index> m_thick;
  std::vector<std::uint8_t> m_is_held; ///< connected to the root by similar wood
  std::vector<Base> m_bases;           ///< of the thick axes
  bool m_may_leave_gaps = false;       ///< whether axes beyond short gaps are held
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_HELD_AXES_H
