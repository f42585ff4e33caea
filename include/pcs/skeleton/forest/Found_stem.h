// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A stem of a stand, and its continuation down to the ground.

#ifndef PCS_SKELETON_FOREST_FOUND_STEM_H
#define PCS_SKELETON_FOREST_FOUND_STEM_H

#include <pcs/skeleton/forest/Stand_options.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// A stem in a scan, and its tree.
struct Found_stem
{
  Index axis = none, tree = none;
  Vec3 foot = Vec3::Zero();
  double radius = 0;           ///< largest radius in the lowest part
  double radius_at_breast = 0; ///< radius at breast height; 0 if the stem ends below it
  double height = 0;           ///< of the foot above the lowest ground around it
  double above_ground = 0; ///< of the foot above the ground below it; 0 if that is not known [L]

  /// Returns the foot on the ground. It stays where it is if the ground is farther than breast
  /// height, and may belong to something else. z points upwards.
  Vec3 foot_on_ground(double breast_height) const
  {
    return std::abs(above_ground) <= breast_height ? Vec3(foot - above_ground * Vec3::UnitZ())
                                                   : foot;
  }
};

/// Returns whether a stem belongs to the tree of a stem of at least its radius. z points upwards.
inline bool are_of_one_tree(const Found_stem& stem,
                            const Found_stem& thicker,
                            double breast_height,
                            const Stand_options& rules)
{
  const Vec3 d = stem.foot - thicker.foot;
  return std::hypot(d.x(), d.y()) < rules.stool_radii * thicker.radius +
                                        rules.stool * breast_height +
                                        rules.lean * std::max({0.0, stem.height, thicker.height});
}

/// Returns the largest radius in the lowest part of a stem.
inline double radius_near(const Axis& axis, const Vec3& foot, double part)
{
  double radius = 0;
  for (const Axis_node& node : axis)
    if (node.point.z() <= foot.z() + part)
      radius = std::max(radius, node.radius);
  return radius;
}

/// Returns how far from its foot a stem may continue below, in the plan [L].
inline double reach_below(const Found_stem& stem, double breast_height, const Stand_options& rules)
{
  return rules.stool_radii * stem.radius + rules.stool * breast_height;
}

/// Returns the largest radius of an axis where it crosses `height` at most `reach` from `foot` in
/// the plan; 0 if it does not [L].
inline double radius_at(const Axis& axis, double height, const Vec3& foot, double reach)
{
  double radius = 0;
  for (std::size_t k = 1; k < axis.size(); ++k) {
    const Axis_node &a = axis[k - 1], &b = axis[k];
    const double low = std::min(a.point.z(), b.point.z()),
                 high = std::max(a.point.z(), b.point.z());
    if (!(low <= height && height < high))
      continue;
    const double t = (height - a.point.z()) / (b.point.z() - a.point.z());
    const Vec3 d = a.point + t * (b.point - a.point) - foot;
    if (std::hypot(d.x(), d.y()) <= reach)
      radius = std::max(radius, a.radius + t * (b.radius - a.radius));
  }
  return radius;
}

/// Returns the radius of a stem at breast height above the ground. If its axis ends below, or is
/// much thinner there, another axis near the foot may continue it, which is not thicker than its
/// lowest part. 0 if there is none. O(nodes of the axes).
inline double radius_at_breast(const Found_stem& stem,
                               const Axis_set& axes,
                               double breast_height,
                               const Stand_options& rules)
{
  constexpr double thin = 0.5; // of the radius of the lowest part [-]
  const double height = stem.foot_on_ground(breast_height).z() + breast_height;
  const double anywhere = std::numeric_limits<double>::infinity();
  double radius = radius_at(axes.axes[stem.axis].axis, height, stem.foot, anywhere);
  if (radius >= thin * stem.radius)
    return radius;
  for (const auto& other : axes.axes) {
    const double r =
        radius_at(other.axis, height, stem.foot, reach_below(stem, breast_height, rules));
    if (r <= stem.radius)
      radius = std::max(radius, r);
  }
  return radius;
}

/// Returns whether a point may lie on the lowest part of a stem, or on its continuation below.
inline bool may_continue(const Found_stem& stem,
                         const Vec3& p,
                         double breast_height,
                         const Stand_options& rules)
{
  const Vec3 d = p - stem.foot;
  return d.z() <= rules.root * breast_height &&
         std::hypot(d.x(), d.y()) <= reach_below(stem, breast_height, rules);
}

/*!
  Continues stems down to the ground. Of a sparsely sampled stem, several axes are fitted, and the
  thickest one may begin in the crown. The points below its foot that are linked to it, directly or
  through each other, show the rest of the stem; the axis with most of the lowest of them is its
  lower part. z points upwards.
*/
class Stem_continuation
{
public:
  /// `breast_height` is in the unit of the scan. Keeps references to the other arguments.
  Stem_continuation(const Scan& scan,
                    const Neighbor_graph& graph,
                    const Axis_set& axes,
                    double breast_height,
                    const Stand_options& rules)
    : m_scan(scan), m_graph(graph), m_axes(axes), m_breast_height(breast_height), m_rules(rules)
  {
  }

  /// Returns the axis of the lowest part of a stem: its own if there is nothing below. Points
  /// below the foot lie as near to it as stems of one tree. O(points below the foot).
  Index lowest_axis(const Found_stem& stem, const std::vector<Index>& points_of_stem) const
  {
    const double part = m_rules.root * m_breast_height;
    std::vector<Index> reached;
    std::set<Index> is_reached;
    const auto reach_point = [&](Index i) {
      if (may_continue(stem, m_scan.points[i], m_breast_height, m_rules) &&
          is_reached.insert(i).second)
        reached.push_back(i);
    };
    for (const Index i : points_of_stem)
      reach_point(i);
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const Index i = reached[k];
      for (const Index* next = m_graph.begin(i); next != m_graph.end(i); ++next)
        reach_point(*next);
    }
    double lowest = stem.foot.z();
    for (const Index i : reached)
      lowest = std::min(lowest, m_scan.points[i].z());
    if (stem.foot.z() - lowest <= m_rules.hidden * m_breast_height)
      return stem.axis;
    std::map<Index, std::size_t> count; // of the lowest points, by axis
    for (const Index i : reached)
      if (m_axes.is_covered(i) && m_scan.points[i].z() <= lowest + part)
        ++count[m_axes.axis_of_point[i]];
    Index best = stem.axis;
    std::size_t most = 0;
    for (const auto& [axis, points] : count)
      if (points > most) {
        best = axis;
        most = points;
      }
    return best;
  }

private:
  const Scan& m_scan;
  const Neighbor_graph& m_graph;
  const Axis_set& m_axes;
  double m_breast_height;
  const Stand_options& m_rules;
};

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_FOUND_STEM_H
