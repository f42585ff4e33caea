// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removal of axes of two points that are not parts of thin branches.

#ifndef PCS_SKELETON_AXES_DROP_TWO_POINT_AXES_H
#define PCS_SKELETON_AXES_DROP_TWO_POINT_AXES_H

#include <pcs/skeleton/model/Axis_set.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for keeping axes of two points.
struct Two_point_axis_options
{
  double ratio = 1.7;     ///< largest number of pairs per axis of three points [-]
  std::size_t fewest = 6; ///< least number of axes of three points [count]
  double share = 0.05;    ///< least fraction of pairs among all axes [-]
};

/*!
  Drops all axes of two points unless their number is plausible for twigs. Barely sampled twigs
  consist of pieces with any number of points, while random neighbours mostly form pairs. Pairs are
  therefore dropped if too many of them exist relative to axes of three points. They are also
  dropped if they are a small fraction of all axes: well sampled twigs are rarely in pieces. Returns
  the number of dropped axes. O(axes + points).
*/
inline std::size_t drop_two_point_axes(const Two_point_axis_options& rules, Axis_set& set)
{
  std::size_t pairs = 0, triples = 0;
  for (const Fitted_axis& a : set.axes) {
    pairs += a.number_of_points == 2;
    triples += a.number_of_points == 3;
  }
  const bool are_twigs = triples >= rules.fewest &&
                         double(pairs) <= rules.ratio * double(triples) &&
                         double(pairs) >= rules.share * double(set.axes.size());
  if (pairs == 0 || are_twigs)
    return 0;
  // new index of each kept axis, and of the nearest kept axis towards the root
  std::vector<Index> own(set.axes.size(), none), next(set.axes.size(), none);
  std::vector<Fitted_axis> kept;
  for (Index a = 0; a < set.axes.size(); ++a) {
    Fitted_axis& axis = set.axes[a];
    if (axis.parent != none)
      axis.parent = next[axis.parent]; // parents come first
    next[a] = axis.parent;
    if (axis.number_of_points == 2)
      continue;
    own[a] = next[a] = static_cast<Index>(kept.size());
    kept.push_back(std::move(axis));
  }
  for (Index& a : set.axis_of_point)
    if (a != none)
      a = own[a];
  set.axes = std::move(kept);
  return pairs;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_DROP_TWO_POINT_AXES_H
