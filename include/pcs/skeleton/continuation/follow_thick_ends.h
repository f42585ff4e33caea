// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Continuation of thick axes through wood with few points.

#ifndef PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H
#define PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H

#include <pcs/internal/progress.h>
#include <pcs/skeleton/axes/Chain_options.h>
#include <pcs/skeleton/continuation/Held_axes.h>
#include <pcs/skeleton/continuation/Thick_continuation.h>
#include <pcs/skeleton/continuation/add_coarse_pieces.h>
#include <pcs/skeleton/continuation/find_coarse_axes.h>
#include <pcs/skeleton/continuation/follow_thick_bases.h>
#include <pcs/skeleton/model/Axis_set.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Result of `follow_thick_ends()`.
struct Followed_ends
{
  std::size_t number_of_pieces = 0; ///< added pieces of coarse axes [count]
  std::size_t number_of_ends = 0;   ///< continued bases [count]
  //! unexplained points around thick bases far from held axes of similar thickness [count]
  std::size_t number_of_unexplained_points = 0;
  bool is_complete = false; ///< not stopped
};

/*!
  Continues thick axes where thick wood has few points, as in the shade of a crown. The level sets
  of such wood fall apart into strands and single points, so that chains explain only the ends of a
  limb.

  First, pieces of coarse axes are added where thick wood is missing (`add_coarse_pieces()`), those
  of the coarsest axes first. Then each thick axis that is not held (`Held_axes`) is continued
  towards the root, by a tube to a held axis or by pieces (`Thick_continuation`) until a tube leads
  to one; if this fails, it does not change, and unexplained points around its base are counted if
  no held axis of similar thickness is near. Points of dense twigs do not support a continuation.
  Last, short gaps are left to `join_axes()`, and the bases beyond them are continued.

  A continued axis takes over the points on its surface from thinner and from much smaller axes, but
  not from held thick ones. Axes that lose most of their points are dropped. `is_used`: points of
  the tree; `root`: points of the root. If `go_on` returns `false`, the work stops, and `set` is of
  no use. O(n log n + t^2) for t thick axes.
*/
inline Followed_ends follow_thick_ends(const Scan& scan,
                                       const std::vector<std::uint8_t>& is_used,
                                       const Chain_options& chains,
                                       const Thick_end_options& rules,
                                       const std::vector<Index>& root,
                                       const std::vector<Coarse_axis>& coarse,
                                       const Coarse_axis_options& coarse_rules,
                                       const pcs::internal::Go_on& go_on,
                                       Axis_set& set)
{
  const std::vector<std::uint8_t> is_free =
      points_of_sparse_wood(scan,
                            is_used,
                            coarse_rules,
                            rules.least_radius(scan.spacing, set.noise),
                            set);
  Held_axes axes(scan, is_free, chains, rules, root, set);
  Followed_ends result;
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    if (!pcs::internal::goes_on(go_on, 0.5 * double(k) / double(coarse.size())))
      return result;
    result.number_of_pieces +=
        add_coarse_pieces(scan, is_used, coarse[k], set.noise, chains, coarse_rules, axes);
  }
  const auto follow = [&](double from) {
    return follow_thick_bases(axes, result.number_of_ends, [&](double f) {
      return pcs::internal::goes_on(go_on, from + 0.25 * f);
    });
  };
  if (!follow(0.5))
    return result;
  axes.leave_gaps();
  if (!follow(0.75))
    return result;
  result.number_of_unexplained_points = axes.count_unexplained();
  axes.drop_lost();
  result.is_complete = true;
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CONTINUATION_FOLLOW_THICK_ENDS_H
