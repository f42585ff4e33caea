// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of held axes beyond the places where they become thin although the wood does not.

#ifndef PCS_SKELETON_CONTINUATION_FOLLOW_THICK_TIPS_H
#define PCS_SKELETON_CONTINUATION_FOLLOW_THICK_TIPS_H

#include <pcs/skeleton/continuation/Held_axes.h>
#include <pcs/skeleton/continuation/Thick_continuation.h>
#include <pcs/skeleton/continuation/thick_line.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Continues one held axis at the first place where pieces of a tube find wood that it misses.
class Thick_tip_follower
{
public:
  Thick_tip_follower(Index a, Held_axes& axes) : m_a(a), m_axes(axes), m_nodes(axes.axes()[a].axis)
  {
  }

  /// Returns whether the axis was continued.
  bool operator()()
  {
    double since = 0; // last trial [L]
    for (std::size_t k = fewest_nodes; k < m_nodes.size(); ++k) {
      since += (m_nodes[k].point - m_nodes[k - 1].point).norm();
      if (m_nodes[k].radius < m_axes.thinnest() || since < m_nodes[k].radius || !does_shrink(k))
        continue;
      since = 0;
      Axis longer(m_nodes.begin(), m_nodes.begin() + static_cast<std::ptrdiff_t>(k) + 1);
      const Axis rest(m_nodes.begin() + static_cast<std::ptrdiff_t>(k), m_nodes.end());
      if (extend(longer) && is_new(rest, longer)) {
        accept(k, rest, std::move(longer));
        return true;
      }
    }
    return false;
  }

private:
  static constexpr std::size_t fewest_nodes = 4; // that define a direction

  /// Returns whether the axis ends within a piece beyond node `k`, or becomes thinner by a quarter
  /// within two.
  bool does_shrink(std::size_t k) const
  {
    const Thick_end_options& rules = m_axes.rules();
    const double radius = m_nodes[k].radius;
    double length = 0;
    for (std::size_t j = k + 1; j < m_nodes.size() && length < 2 * rules.piece * radius; ++j) {
      length += (m_nodes[j].point - m_nodes[j - 1].point).norm();
      if (m_nodes[j].radius < rules.narrowed * radius)
        return true;
    }
    return length < rules.piece * radius;
  }

  /// Adds pieces to `longer`, up to an axis of similar thickness. Returns whether one was found.
  bool extend(Axis& longer) const
  {
    constexpr double steady = 1.05; // wood does not widen towards its tips [-]
    const double widest = steady * longer.back().radius;
    const std::size_t size = longer.size();
    bool is_longer = false;
    for (int k = 0; k < m_axes.rules().most_pieces; ++k) {
      if (longer.back().radius < m_axes.thinnest() || !add_piece(widest, longer))
        return is_longer;
      is_longer = true;
      if (m_axes.is_in_other(m_a, longer.back())) {
        while (longer.size() > 1 && m_axes.is_in_other(m_a, longer.back()))
          longer.pop_back();
        return longer.size() > size;
      }
    }
    return is_longer;
  }
  /// Adds a piece whose radius is at most `widest` [L]. Returns whether one was found.
  bool add_piece(double widest, Axis& longer) const
  {
    const Axis_node end = longer.back();
    for (const double factor : {1.0, 2.0}) {
      const double length = factor * m_axes.rules().piece * end.radius;
      const std::vector<Index> near =
          m_axes.free_points(m_a, Thick_line(), end, length + 2 * end.radius);
      Axis trial = longer;
      if (m_axes.continuation().extend(near, length, {1, 0.8, 0.65}, trial) &&
          trial.back().radius <= widest) {
        longer = std::move(trial);
        return true;
      }
    }
    return false;
  }

  /// Returns whether most of the continuation is wood that the rest of the axis does not explain.
  bool is_new(const Axis& rest, const Axis& longer) const
  {
    const Axis_node& from = rest.front();
    std::size_t count = 0, known = 0;
    for (std::size_t k = longer.size(); k-- > 1;) {
      if ((longer[k].point - from.point).norm() < from.radius)
        break;
      ++count;
      if (rest.size() < 2)
        continue;
      const Axis_place place = nearest_place(rest, longer[k].point);
      known += radius_at(rest, place) >= m_axes.rules().narrowed * longer[k].radius &&
               place.distance < m_axes.rules().touch * longer[k].radius;
    }
    return 2 * known < count;
  }

  /// Returns whether the rest of the axis is a strand of points on the surface of the continuation.
  static bool is_strand(const Axis& rest, const Axis& longer)
  {
    constexpr double reach = 1.5; // in radii [-]
    const double gained = (longer.back().point - rest.front().point).norm();
    std::size_t k = 0;
    for (double length = 0; k + 1 < rest.size() && length < gained; ++k)
      length += (rest[k + 1].point - rest[k].point).norm();
    const Axis_place place = nearest_place(longer, rest[k].point);
    return place.distance < reach * radius_at(longer, place);
  }

  /// The continuation replaces a strand, and is a new branch beside any other rest of the axis.
  void accept(std::size_t k, const Axis& rest, Axis longer)
  {
    if (!is_strand(rest, longer)) {
      const std::size_t base = last_inside(longer);
      m_axes.add(m_a, Axis(longer.begin() + static_cast<std::ptrdiff_t>(base), longer.end()));
      return;
    }
    const std::size_t meeting = m_axes.axes()[m_a].meeting;
    m_axes.replace(m_a, std::move(longer), meeting > k ? 0 : meeting);
    if (rest.size() > 1)
      m_axes.add(m_a, rest);
  }
  /// Returns the last node but one at the most that lies inside the axis.
  std::size_t last_inside(const Axis& longer) const
  {
    std::size_t k = longer.size() - 2;
    const auto is_inside = [&](const Axis_node& node) {
      const Axis_place place = nearest_place(m_nodes, node.point);
      return place.distance < m_axes.rules().touch * radius_at(m_nodes, place);
    };
    while (k > 0 && !is_inside(longer[k]))
      --k;
    return k;
  }

  Index m_a;
  Held_axes& m_axes;
  const Axis m_nodes; ///< of the axis, before its continuation
};

} // namespace internal

/*!
  Continues held axes that end, or become thin, although a tube of points goes on. `was_tried`: by
  axis, whether it was tried before; updated. Returns the number of continued axes.
*/
inline std::size_t follow_thick_tips(std::vector<std::uint8_t>& was_tried, Held_axes& axes)
{
  std::size_t count = 0;
  for (std::size_t k = 0; k < axes.thick().size(); ++k) { // some axes are added
    const Index a = axes.thick()[k];
    was_tried.resize(axes.axes().size(), 0);
    if (!axes.is_held(a) || was_tried[a])
      continue;
    was_tried[a] = 1;
    count += internal::Thick_tip_follower(a, axes)();
  }
  if (count > 0)
    axes.hold_again();
  return count;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_FOLLOW_THICK_TIPS_H
