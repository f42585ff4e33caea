// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of the bases of thick axes that are not held.

#ifndef PCS_SKELETON_CONTINUATION_FOLLOW_THICK_BASES_H
#define PCS_SKELETON_CONTINUATION_FOLLOW_THICK_BASES_H

#include <pcs/skeleton/continuation/Held_axes.h>
#include <pcs/skeleton/continuation/Thick_continuation.h>
#include <pcs/skeleton/continuation/thick_line.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Continues the base of one thick axis that is not held.
class Thick_base_follower
{
public:
  Thick_base_follower(Index a, Held_axes& axes) : m_a(a), m_axes(axes), m_line(axes.line_to_base(a))
  {
  }

  /// Continues the base up to a held axis. Returns whether this succeeded.
  bool operator()()
  {
    if (m_line.nodes.empty())
      return false;
    Axis longer = m_line.nodes;
    bool is_done = connect(longer);
    for (const Thick_trial& trial :
         {Thick_trial{1, 2, false}, {1, 2, true}, {2, 1, false}, {2, 1, true}}) {
      if (is_done)
        break;
      longer = m_line.nodes;
      is_done = extend_and_connect(trial, longer);
    }
    if (is_done)
      accept(std::move(longer));
    return is_done;
  }

private:
  /// Adds pieces to `longer` until it lies on a held axis or a tube leads to one.
  bool extend_and_connect(const Thick_trial& trial, Axis& longer) const
  {
    const Thick_end_options& rules = m_axes.rules();
    const double thickest = rules.widest * longer.back().radius;
    for (int k = 0; k < rules.most_pieces; ++k) {
      if (!extend(trial, longer) || longer.back().radius > thickest)
        return false;
      if (m_axes.is_on_held(m_a, longer.back(), m_axes.direction_of(longer)) || connect(longer))
        return true;
    }
    return false;
  }
  /// Adds a piece to `longer`. Returns whether a piece was found.
  bool extend(const Thick_trial& trial, Axis& longer) const
  {
    const Axis_node end = longer.back();
    for (const double factor : {trial.first, trial.second}) {
      const double length = factor * m_axes.rules().piece * end.radius;
      const std::vector<Index> near = m_axes.free_points(m_a, m_line, end, length + 2 * end.radius);
      const std::vector<double> ratios = trial.does_radius_change
                                             ? std::vector<double>{1, 1.25, 1.5} // wood widens
                                             : std::vector<double>{1};
      if (m_axes.continuation().extend(near, length, ratios, longer))
        return true;
    }
    return false;
  }
  /// Adds a tube to a held axis. Returns whether one was found.
  bool connect(Axis& longer) const
  {
    const Axis_node end = longer.back();
    const std::vector<Thick_target> targets =
        m_axes.targets_ahead(end, m_axes.direction_of(longer));
    const double reach = m_axes.rules().longest * end.radius;
    return !targets.empty() &&
           m_axes.continuation().connect(m_axes.free_points(m_a, m_line, end, reach),
                                         targets,
                                         longer);
  }
  /// Replaces the axis by its continued line. The other branch of a fork becomes a new axis.
  void accept(Axis longer)
  {
    const Fitted_axis& axis = m_axes.axes()[m_a];
    const bool is_split = !m_line.rest.empty();
    const std::size_t beyond = axis.axis.size() - axis.meeting; // nodes of the outer piece
    const bool is_met = axis.meeting > 0 && !is_split && beyond < longer.size();
    const std::size_t meeting = is_met ? longer.size() - beyond : 0;
    std::reverse(longer.begin(), longer.end());
    m_axes.replace(m_a, std::move(longer), meeting);
    const Axis& rest = m_line.rest;
    if (is_split && length_of(rest) > m_axes.rules().least * rest.back().radius)
      m_axes.add(m_a, Axis(rest.rbegin(), rest.rend()));
    m_axes.hold(m_a);
  }

  Index m_a;
  Held_axes& m_axes;
  Thick_line m_line;
};

} // namespace internal

/// Continues the bases of all thick axes that are not held, in the order of `Held_axes::thick()`,
/// and adds their number to `count`. Returns `false` if `go_on` stopped the work.
template <class Go_on>
bool follow_thick_bases(Held_axes& axes, std::size_t& count, const Go_on& go_on)
{
  for (std::size_t k = 0; k < axes.thick().size(); ++k) { // some axes are added
    if (!go_on(double(k) / double(axes.thick().size())))
      return false;
    if (const Index a = axes.thick()[k]; !axes.is_held(a))
      count += internal::Thick_base_follower(a, axes)();
  }
  return true;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_FOLLOW_THICK_BASES_H
