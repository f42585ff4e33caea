// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removal of axes of two points that are not parts of thin branches.

#ifndef PCS_SKELETON_AXES_DROP_TWO_POINT_AXES_H
#define PCS_SKELETON_AXES_DROP_TWO_POINT_AXES_H

#include <pcs/skeleton/axes/remove_axes.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <cstddef>

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
  remove_axes([&](Index a) { return set.axes[a].number_of_points == 2; }, set);
  return pairs;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_DROP_TWO_POINT_AXES_H
