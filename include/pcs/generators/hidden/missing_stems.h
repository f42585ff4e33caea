// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Thick axes that the skeleton lacks: where one ends blunt, or is thinner beyond a fork.

#ifndef PCS_GENERATORS_HIDDEN_MISSING_STEMS_H
#define PCS_GENERATORS_HIDDEN_MISSING_STEMS_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/hidden/Beam_visibility.h>
#include <pcs/generators/hidden/Hidden_branches.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace pcs {
namespace generators {
namespace hidden {

/*
  By the pipe model, the area of a section equals the areas of the sections that it branches into. A
  missing part of this area belongs to an axis that the skeleton lacks. It is completed if it is
  thick, since only thick axes have accurate radii, and if most beams end before or at its place.
*/
class Missing_stems
{
public:
  Missing_stems(const habit::Tree_sample& tree,
                const Tree_habit& habit,
                const Beam_visibility& visibility)
    : m_tree(tree), m_habit(habit), m_visibility(visibility), m_children(tree.axes.size())
  {
    for (const habit::Axis& a : tree.axes) {
      if (a.parent != npos)
        m_children[a.parent].push_back(&a);
      for (const Vector3& p : a.points)
        m_top = std::max(m_top, p.z());
    }
  }

  std::vector<Inferred_branch> operator()() const
  {
    constexpr double least_share = 0.3; // of the radius of the trunk
    std::vector<Inferred_branch> result;
    const habit::Axis& trunk = m_tree.axes.front();
    const double limit = least_share * radius_at(trunk, 0.1 * trunk.length());
    for (std::size_t a = 0; a < m_tree.axes.size(); ++a) {
      const habit::Axis& axis = m_tree.axes[a];
      if (axis.kind == habit::Axis_kind::stub)
        continue;
      if (const auto gap = largest_gap(a, limit))
        if (const auto stem = continued(a, *gap))
          result.push_back(*stem);
    }
    return result;
  }

private:
  /// A place where a section is missing: the point of the axis, and the radius of the section.
  struct Gap
  {
    std::size_t point;
    double radius, at;
  };

  /// The middle one of several values.
  static double median(std::vector<double> values)
  {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  static double radius_at(const habit::Axis& axis, double at)
  {
    const auto next = std::lower_bound(axis.at.begin(), axis.at.end(), at);
    const auto i = std::min(static_cast<std::size_t>(next - axis.at.begin()), axis.at.size() - 1);
    return axis.radius[i];
  }

  /// The median radius of an axis between two lengths from its base; 0 beyond its end.
  static double median_radius(const habit::Axis& axis, double from, double to)
  {
    std::vector<double> values;
    for (double at = from; at <= to; at += (to - from) / 16)
      values.push_back(at > axis.length() ? 0 : radius_at(axis, at));
    return median(values);
  }

  /// The largest missing section of an axis, if it is thicker than `limit`. Radii beyond a place
  /// are medians over a few diameters, since fits may collapse or grow at single places.
  std::optional<Gap> largest_gap(std::size_t number, double limit) const
  {
    constexpr double least_share = 0.45; // of the radius of the axis; errors of radii are smaller
    constexpr double thick_child = 0.4;  // thinner branches hardly change the radius of a stem
    constexpr double flare = 6;          // radii of the foot, up to which a trunk may flare
    const habit::Axis& axis = m_tree.axes[number];
    std::optional<Gap> best;
    for (std::size_t i = 0; i < axis.at.size(); ++i) {
      const double at = axis.at[i], before = axis.radius[i], window = 1.5 * before;
      if (before < limit || (axis.order == 0 && at < flare * axis.base_radius()))
        continue;
      double area =
          std::pow(before, 2) - std::pow(median_radius(axis, at + window, at + 5 * window), 2);
      for (const habit::Axis* child : m_children[number])
        if (child->place_at > at - window && child->place_at < at + 5 * window) {
          const double r = median_radius(*child, 0, 5 * window);
          area -= r > thick_child * before ? r * r : 0;
        }
      const double radius = std::sqrt(std::max(0.0, area));
      if (radius > least_share * before && radius > limit && (!best || radius > best->radius))
        best = Gap{i, radius, at};
    }
    return best;
  }

  Vector3 direction(const habit::Axis& axis, double from, double to) const
  {
    Vector3 first = axis.points.front(), last = axis.points.back();
    for (std::size_t i = 0; i < axis.at.size(); ++i) {
      if (axis.at[i] <= from)
        first = axis.points[i];
      if (axis.at[i] <= to)
        last = axis.points[i];
    }
    const Vector3 d = last - first;
    return d.norm() > 0 ? Vector3(d.normalized()) : Vector3(Vector3::UnitZ());
  }

  std::optional<Inferred_branch> continued(std::size_t a, const Gap& gap) const
  {
    constexpr double fewest_blocked = 0.5;
    const habit::Axis& axis = m_tree.axes[a];
    const double span = 6 * axis.radius[gap.point];
    Vector3 d = direction(axis, gap.at - span, gap.at);
    if (radius_at(axis, gap.at + span) > gap.radius / 2) { // the stems lean apart
      const Vector3 other = direction(axis, gap.at, gap.at + span);
      d = (2 * d.dot(other) * d - other).normalized();
    }
    const double rise = m_top - axis.points[gap.point].z();
    const habit::Axis& trunk = m_tree.axes.front();
    const double slender =
        (m_top - trunk.points.front().z()) / radius_at(trunk, 0.1 * trunk.length());
    const double length = std::min(slender * gap.radius, rise / std::max(0.5, d.z()));
    if (!(length > 4 * gap.radius))
      return std::nullopt;
    Inferred_branch stem;
    stem.parent = a;
    stem.place = gap.point;
    stem.order = axis.order + 1;
    constexpr int steps = 20;
    double blocked = 0;
    for (int k = 0; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      stem.points.push_back(axis.points[gap.point] + t * length * d);
      const double share = m_habit.tip_share[0];
      stem.radii.push_back(gap.radius * ((1 - share) * std::pow(1 - t, m_habit.taper[0]) + share));
      if (k < steps / 2)
        blocked +=
            m_visibility.blocked_share(stem.points.back(), 2 * stem.radii.back()) / (steps / 2);
    }
    if (blocked < fewest_blocked)
      return std::nullopt;
    return stem;
  }

  const habit::Tree_sample& m_tree;
  const Tree_habit& m_habit;
  const Beam_visibility& m_visibility;
  std::vector<std::vector<const habit::Axis*>> m_children; // of each axis
  double m_top = -std::numeric_limits<double>::infinity();
};

} // namespace hidden
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_MISSING_STEMS_H
