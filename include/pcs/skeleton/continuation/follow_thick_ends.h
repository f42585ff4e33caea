// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of thick axes to their parents through wood with few points.

#ifndef PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H
#define PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H

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

namespace internal {

/// Continues the bases of thick axes that are not held, see `follow_thick_ends()`.
class Thick_end_follower
{
public:
  /// Keeps references to all arguments. `root`: points of the root.
  Thick_end_follower(const Scan& scan,
                     const Chain_options& chains,
                     const Thick_end_options& rules,
                     const std::vector<Index>& root,
                     Axis_set& set)
    : m_scan(scan),
      m_chains(chains),
      m_rules(rules),
      m_root(root),
      m_set(set),
      m_thinnest(std::max(rules.thinnest * scan.spacing, rules.noise * set.noise)),
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

  /// Continues all bases that are not held, thickest first. Short gaps that remain are left to
  /// `join_axes()`; then continues the bases beyond them. Returns the number of continued bases.
  std::size_t follow_all()
  {
    const std::size_t count = follow_loose();
    m_may_leave_gaps = true;
    hold_more();
    return count + follow_loose();
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

  /// Drops the axes that lost most of their points.
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
  /// Base of an axis, and a ball around the whole axis.
  struct Base
  {
    Axis_node node;
    Vec3 along;        ///< direction beyond the base
    Vec3 center;       ///< of the ball
    double extent = 0; ///< radius of the ball [L]
  };

  /// Finds the axes that may have thick bases, thickest first.
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
  Thick_line line_of(Index a) const
  {
    return line_to_base(m_set.axes[a].axis, m_thinnest, m_chains, m_rules);
  }
  Vec3 direction_of(const Axis& line) const
  {
    return Thick_line::direction_of(line, m_rules.piece * line.back().radius);
  }
  void measure(Index a)
  {
    const Axis& axis = m_set.axes[a].axis;
    Axis line = line_of(a).nodes;
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
  /// Holds all axes whose bases lie on held axes.
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
  bool is_held_within(Index b, const Axis_node& end, double radii) const
  {
    const double reach = m_bases[b].extent + radii * end.radius;
    return m_is_held[b] && (m_bases[b].center - end.point).squaredNorm() <= reach * reach;
  }
  bool is_ahead(const Vec3& d, const Vec3& along) const
  {
    return d.dot(along) > std::cos(m_rules.widest_turn) * d.norm();
  }

  std::size_t follow_loose()
  {
    std::size_t count = 0;
    for (std::size_t k = 0; k < m_thick.size(); ++k) // `follow()` appends axes
      count += !m_is_held[m_thick[k]] && follow(m_thick[k]);
    return count;
  }

  /// Continues the base of axis `a` up to a held axis. Returns whether this succeeded.
  bool follow(Index a)
  {
    const Thick_line line = line_of(a);
    if (line.nodes.empty())
      return false;
    Axis longer = line.nodes;
    bool is_done = connect(a, line, longer);
    for (const Thick_trial& trial :
         {Thick_trial{1, 2, false}, {1, 2, true}, {2, 1, false}, {2, 1, true}}) {
      if (is_done)
        break;
      longer = line.nodes;
      is_done = extend_and_connect(a, line, trial, longer);
    }
    if (is_done)
      accept(a, line, std::move(longer));
    return is_done;
  }
  /// Adds pieces to `longer` until it lies on a held axis or a tube leads to one.
  bool
  extend_and_connect(Index a, const Thick_line& line, const Thick_trial& trial, Axis& longer) const
  {
    const double thickest = m_rules.widest * longer.back().radius;
    for (int k = 0; k < m_rules.most_pieces; ++k) {
      if (!extend(a, line, trial, longer) || longer.back().radius > thickest)
        return false;
      if (is_on_held(a, longer.back(), direction_of(longer)) || connect(a, line, longer))
        return true;
    }
    return false;
  }
  /// Adds a piece to `longer`. Returns whether a piece was found.
  bool extend(Index a, const Thick_line& line, const Thick_trial& trial, Axis& longer) const
  {
    Thick_continuation continuation(m_scan, m_set.noise, m_chains, m_rules);
    const Axis_node end = longer.back();
    for (const double factor : {trial.first, trial.second}) {
      const double length = factor * m_rules.piece * end.radius;
      const std::vector<Index> near = free_points(a, line, end, length + 2 * end.radius);
      if (continuation.extend(near, length, trial.does_radius_change, longer))
        return true;
    }
    return false;
  }
  /// Adds a tube to a held axis. Returns whether one was found.
  bool connect(Index a, const Thick_line& line, Axis& longer) const
  {
    const Axis_node end = longer.back();
    const std::vector<Thick_target> targets = targets_ahead(end, direction_of(longer));
    if (targets.empty())
      return false;
    return Thick_continuation(m_scan, m_set.noise, m_chains, m_rules)
        .connect(free_points(a, line, end, m_rules.longest * end.radius), targets, longer);
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
    if (m_scan.is_outlier[i])
      return false;
    return !m_set.is_covered(i) || m_set.axis_of_point[i] == a ||
           radius_of(i) < m_rules.released * radius || is_small(m_set.axis_of_point[i], a);
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
      return is_rest || !may_take(i, a, end.radius);
    };
    near.erase(std::remove_if(near.begin(), near.end(), is_taken), near.end());
    return near;
  }
  /// Marks the unexplained points around the base of axis `a` if no held axis of similar thickness
  /// is near: a part of a thick branch is missing there.
  void mark_unexplained(Index a, std::vector<std::uint8_t>& is_marked) const
  {
    const Thick_line line = line_of(a);
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

  /// Replaces axis `a` by its continued line. The other branch of a fork becomes a new axis.
  void accept(Index a, const Thick_line& line, Axis longer)
  {
    Fitted_axis& axis = m_set.axes[a];
    const bool is_split = !line.rest.empty();
    const std::size_t beyond = axis.axis.size() - axis.meeting; // nodes of the outer piece
    const bool is_met = axis.meeting > 0 && !is_split && beyond < longer.size();
    axis.meeting = is_met ? longer.size() - beyond : 0;
    std::reverse(longer.begin(), longer.end());
    replace(a, std::move(longer));
    m_is_held[a] = 1;
    if (is_split && length_of(line.rest) > m_rules.least * line.rest.back().radius)
      add(a, Axis(line.rest.rbegin(), line.rest.rend()));
    hold_more();
  }
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
    replace(b, std::move(nodes));
  }
  /// Replaces the nodes of axis `a`, and assigns to it the points on its surface.
  void replace(Index a, Axis nodes)
  {
    m_set.axes[a].axis = std::move(nodes);
    const Axis& axis = m_set.axes[a].axis;
    std::vector<Index> points;
    for (const Index i : points_near(a)) {
      const Axis_place place = nearest_place(axis, m_scan.points[i]);
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
  /// Returns the largest distance from the surface of explained points outside it [L].
  double cover(double radius) const
  {
    return std::max(m_chains.cover_offset * m_scan.spacing, m_chains.cover_factor * radius);
  }
  /// Returns the points that axis `a` explains, and those near it.
  std::vector<Index> points_near(Index a) const
  {
    std::vector<Index> near = m_points[a];
    const Axis& axis = m_set.axes[a].axis;
    for (std::size_t k = 0; k + 1 < axis.size(); ++k) {
      const double length = (axis[k + 1].point - axis[k].point).norm();
      const double r = std::max(axis[k].radius, axis[k + 1].radius);
      m_scan.search->append_within(axis[k].point, length + r + cover(r), near);
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
  }

  const Scan& m_scan;
  const Chain_options& m_chains;
  const Thick_end_options& m_rules;
  const std::vector<Index>& m_root;
  Axis_set& m_set;
  double m_thinnest;                        ///< least radius of a thick base [L]
  std::vector<std::size_t> m_lost;          ///< points taken from each axis [count]
  std::vector<std::vector<Index>> m_points; ///< of each axis
  std::vector<Index> m_thick;               ///< axes that may have thick bases
  std::vector<std::uint8_t> m_is_held;      ///< connected to the root by similar wood
  std::vector<Base> m_bases;                ///< of the thick axes
  bool m_may_leave_gaps = false;            ///< whether axes beyond short gaps are held
};

} // namespace internal

/// Result of `follow_thick_ends()`.
struct Followed_ends
{
  std::size_t number_of_ends = 0; ///< continued bases [count]
  //! unexplained points around thick bases far from held axes of similar thickness [count]
  std::size_t number_of_unexplained_points = 0;
};

/*!
  Continues thick axes towards the root where thick wood has few points, as in the shade of a crown.
  The level sets of such wood fall apart into strands and single points, so that chains explain only
  the ends of a limb.

  An axis is held if its base lies at the root or on a held axis of similar thickness, so that wood
  of similar thickness connects it to the root. Loose axes thus never hold each other, as two
  branches beyond a gap below their fork. Each thick axis that is not held is continued by a tube to
  a held axis, or by pieces (`Thick_continuation`) until a tube leads to one; if this fails, it does
  not change, and unexplained points around its base are counted if no held axis of
  similar thickness is near. A continued axis takes over the points on its
  surface from thinner and from much smaller axes. Axes that lose most of their points are dropped.
  `root`: points of the root. O(n + t^2 + points near the loose bases) for t thick axes.
*/
inline Followed_ends follow_thick_ends(const Scan& scan,
                                       const Chain_options& chains,
                                       const Thick_end_options& rules,
                                       const std::vector<Index>& root,
                                       Axis_set& set)
{
  internal::Thick_end_follower follower(scan, chains, rules, root, set);
  Followed_ends result;
  result.number_of_ends = follower.follow_all();
  result.number_of_unexplained_points = follower.count_unexplained();
  follower.drop_lost();
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H
