// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Thick axes that the skeleton lacks: where one ends blunt, or is thinner beyond a fork.

#ifndef PCS_GENERATORS_HIDDEN_MISSING_STEMS_H
#define PCS_GENERATORS_HIDDEN_MISSING_STEMS_H

#include <pcs/generators/Tree_habit.h>
#include <pcs/generators/habit/Tree_sample.h>
#include <pcs/generators/hidden/Beam_visibility.h>
#include <pcs/generators/hidden/Hidden_branches.h>
#include <pcs/generators/hidden/pipe_radii.h>
#include <pcs/generators/internal/Tree_growth.h>
#include <pcs/internal/constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

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

  /// The largest missing section of an axis, if it is thicker than `limit`. Radii beyond a place
  /// are medians over a few diameters, since fits may collapse or grow at single places.
  std::optional<Gap> largest_gap(std::size_t number, double limit) const
  {
    constexpr double least_share = 0.55; // of the radius of the axis; errors of radii are smaller
    constexpr double thick_child = 0.5;  // thinner branches hardly change the radius of a stem
    constexpr double flare = 6;          // radii of the foot, up to which a trunk may flare
    const habit::Axis& axis = m_tree.axes[number];
    std::optional<Gap> best;
    for (std::size_t i = 0; i < axis.at.size(); ++i) {
      const double at = axis.at[i], window = 1.5 * axis.radius[i];
      const double before =
          std::min(axis.radius[i], median_radius(axis, std::max(0.0, at - 3 * window), at));
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

  /// The stem in a direction from a gap; its volume follows the taper of the habit.
  Inferred_branch stem_along(std::size_t a, const Gap& gap, double length, const Vector3& d) const
  {
    constexpr int steps = 20;
    const habit::Axis& axis = m_tree.axes[a];
    Inferred_branch stem;
    stem.parent = a;
    stem.place = gap.point;
    stem.order = axis.order + 1;
    const double share = m_habit.tip_share[0];
    for (int k = 0; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      stem.points.push_back(axis.points[gap.point] + t * length * d);
      stem.radii.push_back(gap.radius * ((1 - share) * std::pow(1 - t, m_habit.taper[0]) + share));
    }
    return stem;
  }

  /// The share of the beams that end before or inside the lower half of a stem.
  double blocked_share(const Inferred_branch& stem) const
  {
    const std::size_t half = stem.points.size() / 2;
    double sum = 0;
    for (std::size_t k = 0; k < half; ++k)
      sum += m_visibility.blocked_share(stem.points[k], 2 * stem.radii[k]);
    return sum / static_cast<double>(half);
  }

  /// The stem beyond a gap, in the direction of the axis, or where beams are blocked most.
  std::optional<Inferred_branch> continued(std::size_t a, const Gap& gap) const
  {
    constexpr double fewest_blocked = 0.5;
    constexpr int number_of_turns = 16;
    const habit::Axis& axis = m_tree.axes[a];
    const double span = 6 * axis.radius[gap.point];
    const Vector3 before = direction(axis, gap.at - span, gap.at);
    const habit::Axis& trunk = m_tree.axes.front();
    const double rise = m_top - axis.points[gap.point].z();
    const double slender =
        (m_top - trunk.points.front().z()) / radius_at(trunk, 0.1 * trunk.length());
    std::optional<Inferred_branch> best;
    double most = fewest_blocked;
    const Vector3 normal = internal::any_normal(before);
    for (const double tilt : {0.0, 0.2, 0.4, 0.6}) {
      for (int k = 0; k < (tilt > 0 ? number_of_turns : 1); ++k) {
        const double turn = 2 * pcs::internal::pi * k / number_of_turns;
        const Vector3 d =
            Eigen::AngleAxisd(turn, before) * (Eigen::AngleAxisd(tilt, normal) * before);
        const double length = std::min(slender * gap.radius, rise / std::max(0.5, d.z()));
        if (!(length > 4 * gap.radius))
          continue;
        const Inferred_branch stem = stem_along(a, gap, length, d);
        const double blocked = blocked_share(stem);
        if (blocked > most) {
          most = blocked;
          best = stem;
        }
      }
      if (best)
        return best; // the smallest change of direction
    }
    return std::nullopt;
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
