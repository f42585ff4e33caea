// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of thick axes to their parents through wood with few points.

#ifndef PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H
#define PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H

#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/axes/remove_axes.h>
#include <pcs/skeleton/continuation/Thick_continuation.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Continues the bases of thick axes.
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
      m_points(set.axes.size())
  {
    for (Index i = 0; i < scan.size(); ++i)
      if (set.is_covered(i))
        m_points[set.axis_of_point[i]].push_back(i);
  }

  /// Returns the axes that may have thick bases, thickest first.
  std::vector<Index> thick_axes() const
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
    std::vector<Index> axes;
    for (const auto& t : thick)
      axes.push_back(t.second);
    return axes;
  }

  /// Continues the base of axis `a` up to another axis or the root. Returns whether this succeeded.
  bool follow(Index a)
  {
    const Axis line = line_to_base(a);
    if (line.empty() || is_joined(a, line.back()))
      return false;
    const double thickest = m_rules.widest * line.back().radius;
    const double least = length_of(line) + m_rules.least * line.back().radius;
    for (const Thick_trial& trial :
         {Thick_trial{1, 2, false}, {1, 2, true}, {2, 1, false}, {2, 1, true}}) {
      Axis longer = line;
      bool is_end_joined = false;
      for (int k = 0; k < m_rules.most_pieces && !is_end_joined; ++k) {
        if (!extend(a, trial, longer) || longer.back().radius > thickest)
          break;
        is_end_joined = is_joined(a, longer.back());
      }
      if (!is_end_joined || length_of(longer) < least)
        continue;
      std::reverse(longer.begin(), longer.end());
      replace(a, std::move(longer));
      return true;
    }
    return false;
  }

  /// Marks the unexplained points around the base of axis `a` if no wood of similar thickness is
  /// near: a part of a thick branch is missing there.
  void mark_unexplained(Index a, std::vector<std::uint8_t>& is_marked) const
  {
    const Axis line = line_to_base(a);
    if (line.empty())
      return;
    const Axis_node& end = line.back();
    std::vector<Index> near, open;
    m_scan.search->append_within(end.point, m_rules.loose * end.radius, near);
    for (const Index i : near)
      if (m_set.is_covered(i)) {
        if (is_similar(a, end.radius, i))
          return;
      } else if (!m_scan.is_outlier[i])
        open.push_back(i);
    if (open.size() < m_rules.fewest || is_joined(a, end))
      return;
    for (const Index i : open)
      is_marked[i] = 1;
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
  double radius_of(Index i) const
  {
    return m_set.axes[m_set.axis_of_point[i]].axis[m_set.segment_of_point[i]].radius;
  }
  bool is_small(Index b, Index a) const
  {
    return double(m_set.axes[b].number_of_points) <
           m_rules.small * double(m_set.axes[a].number_of_points);
  }
  /// Returns whether the covered point `i` belongs to another axis that may support axis `a`.
  /// `radius`: of axis `a` at its end [L].
  bool is_similar(Index a, double radius, Index i) const
  {
    const Index b = m_set.axis_of_point[i];
    return b != a && radius_of(i) >= m_rules.touched * radius && !is_small(b, a);
  }
  /// Returns whether axis `a` may explain the point `i`. `radius`: of axis `a` near the point [L].
  bool may_take(Index i, Index a, double radius) const
  {
    if (m_scan.is_outlier[i])
      return false;
    return !m_set.is_covered(i) || m_set.axis_of_point[i] == a ||
           radius_of(i) < m_rules.released * radius || is_small(m_set.axis_of_point[i], a);
  }

  /// Returns the nodes of axis `a` from the tip to the base. A thin base is left out, as in
  /// `cut_thin_base()`. Returns no nodes if the base is not thick.
  Axis line_to_base(Index a) const
  {
    Axis line(m_set.axes[a].axis.rbegin(), m_set.axes[a].axis.rend());
    const double thickest = steady_radius(line);
    std::size_t size = line.size();
    bool is_thin = false;
    for (; size > 0 && line[size - 1].radius < m_rules.firm_base * thickest; --size)
      is_thin = is_thin || line[size - 1].radius < m_chains.thin_base * thickest;
    if (is_thin)
      line.resize(size);
    constexpr std::size_t fewest = 4; // nodes that define a direction
    if (line.size() < fewest || line.back().radius < m_thinnest)
      line.clear();
    return line;
  }
  /// Returns the largest radius that is maintained along a stretch of `steady` radii [L].
  double steady_radius(const Axis& line) const
  {
    double thickest = 0;
    for (std::size_t k = line.size(); k-- > 0;) {
      const double wanted = m_chains.steady * line[k].radius;
      double length = 0, narrowest = line[k].radius;
      for (std::size_t e = k; e > 0 && length < wanted && narrowest > thickest; --e) {
        length += (line[e].point - line[e - 1].point).norm();
        narrowest = std::min(narrowest, line[e - 1].radius);
      }
      if (length >= wanted)
        thickest = std::max(thickest, narrowest);
    }
    return thickest;
  }

  /// Returns whether an end of axis `a` lies at the root or on another thick axis.
  bool is_joined(Index a, const Axis_node& end) const
  {
    const double near = m_rules.at_root * end.radius;
    if (std::any_of(m_root.begin(), m_root.end(), [&](Index i) {
          return (m_scan.points[i] - end.point).squaredNorm() < near * near;
        }))
      return true;
    std::vector<Index> seen{a};
    return is_on_axis(end, true, seen);
  }
  /// Returns whether an end of axis `seen.front()` lies on an axis outside of `seen`. The loose
  /// base of another axis does not count: both axes then belong to a loose branch.
  bool is_on_axis(const Axis_node& end, bool does_check_base, std::vector<Index>& seen) const
  {
    std::vector<Index> near;
    m_scan.search->append_within(end.point, 6 * end.radius + 4 * m_scan.spacing, near);
    for (const Index i : near) {
      if (!m_set.is_covered(i) || !is_similar(seen.front(), end.radius, i))
        continue;
      const Index b = m_set.axis_of_point[i];
      if (std::find(seen.begin(), seen.end(), b) != seen.end())
        continue;
      seen.push_back(b);
      const Axis& axis = m_set.axes[b].axis;
      const Axis_place place = nearest_place(axis, end.point);
      const double radius = radius_at(axis, place);
      if (radius < m_rules.touched * end.radius ||
          place.distance >= radius + m_rules.touch * end.radius)
        continue;
      const bool is_at_base =
          (point_at(axis, place) - axis.front().point).norm() < m_chains.steady * end.radius;
      if (!is_at_base || (does_check_base && is_on_axis(axis.front(), false, seen)))
        return true;
    }
    return false;
  }

  /// Adds a piece to `line`, which belongs to axis `a`. Returns whether a piece was found.
  bool extend(Index a, const Thick_trial& trial, Axis& line) const
  {
    Thick_continuation continuation(m_scan, m_set.noise, m_chains, m_rules);
    const Axis_node end = line.back();
    for (const double factor : {trial.first, trial.second}) {
      const double length = factor * m_rules.piece * end.radius;
      std::vector<Index> near;
      m_scan.search->append_within(end.point, length + 2 * end.radius, near);
      near.erase(std::remove_if(near.begin(),
                                near.end(),
                                [&](Index i) { return !may_take(i, a, end.radius); }),
                 near.end());
      if (continuation.extend(near, length, trial.does_radius_change, line))
        return true;
    }
    return false;
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
};

} // namespace internal

/// Result of `follow_thick_ends()`.
struct Followed_ends
{
  std::size_t number_of_ends = 0; ///< continued bases [count]
  //! unexplained points around thick bases without wood of similar thickness [count]
  std::size_t number_of_unexplained_points = 0;
};

/*!
  Continues thick axes towards the root where thick wood has few points, as in the shade of a crown.
  The level sets of such wood fall apart into strands and single points, so that chains explain only
  the ends of a limb. A thick base is loose if it lies neither at the root nor on an axis of similar
  thickness. It is continued by pieces (`Thick_continuation`) until it lies at one of these; if this
  fails, its axis does not change. A continued axis takes over the points on its surface from
  thinner and from much smaller axes. Axes that lose most of their points are dropped. `root`:
  points of the root. O(n + points near the continued axes).
*/
inline Followed_ends follow_thick_ends(const Scan& scan,
                                       const Chain_options& chains,
                                       const Thick_end_options& rules,
                                       const std::vector<Index>& root,
                                       Axis_set& set)
{
  internal::Thick_end_follower follower(scan, chains, rules, root, set);
  const std::vector<Index> axes = follower.thick_axes();
  Followed_ends result;
  for (const Index a : axes)
    result.number_of_ends += follower.follow(a);
  std::vector<std::uint8_t> is_marked(scan.size(), 0);
  for (const Index a : axes)
    follower.mark_unexplained(a, is_marked);
  result.number_of_unexplained_points =
      static_cast<std::size_t>(std::count(is_marked.begin(), is_marked.end(), 1));
  follower.drop_lost();
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H
