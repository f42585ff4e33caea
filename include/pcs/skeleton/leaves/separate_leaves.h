// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Leaf-wood separation over several rounds: points first, then axes.

#ifndef PCS_SKELETON_LEAVES_SEPARATE_LEAVES_H
#define PCS_SKELETON_LEAVES_SEPARATE_LEAVES_H

#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/leaves/classify_leaves.h>
#include <pcs/skeleton/leaves/wood_score_of_axes.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// The state of a leaf-wood separation between rounds.
struct Leaf_state
{
  int rounds = 0;                    ///< rounds in which points were removed
  bool has_leaves = false;           ///< otherwise only points far from wood were removed
  bool is_in_rows = false;           ///< the points lie in rows, where leaves cannot be recognized
  std::vector<float> wood_score;     ///< log-odds of wood, by point; empty: unknown
  std::vector<std::uint8_t> is_stem; ///< wood of the stem, by point; empty without leaves
};

/// Returns the points of axes that are wood; without leaves, all points except outliers.
template <class ConcurrencyTag>
std::vector<std::uint8_t> wood_by_axes(const Scan& scan,
                                       const Axis_set& axes,
                                       const std::vector<std::uint8_t>& is_used,
                                       const Shortest_paths& paths,
                                       double breast_height,
                                       const Leaf_options& options,
                                       const Leaf_state& state)
{
  return wood_of_scored_axes<ConcurrencyTag>(
      scan,
      axes,
      is_used,
      paths,
      state.wood_score,
      breast_height,
      state.has_leaves ? options.axis_likeness : options.bare_axis_likeness,
      state.has_leaves ? std::numeric_limits<double>::infinity() : options.bare_point_likeness);
}

/*!
  Performs the first round, which classifies single points. `trunk()` is the axis of the trunk; if
  no leaves are found, the root and the surroundings of the trunk remain wood. Returns an empty
  vector if the points cannot be classified.
*/
template <class ConcurrencyTag, class Trunk>
std::vector<std::uint8_t> wood_by_points(const Scan& scan,
                                         const Axis_set& axes,
                                         const std::vector<std::uint8_t>& is_used,
                                         const Shortest_paths& paths,
                                         const std::vector<Index>& root,
                                         const Trunk& trunk,
                                         bool is_sure,
                                         double breast_height,
                                         const Leaf_options& options,
                                         Leaf_state& state)
{
  Found_wood found =
      classify_wood_points<ConcurrencyTag>(scan, axes, is_used, paths, is_sure, options);
  state.is_in_rows = found.is_in_rows;
  state.wood_score = std::move(found.wood_score);
  state.has_leaves = !found.is_wood.empty();
  if (state.has_leaves || state.wood_score.empty())
    return std::move(found.is_wood);
  std::vector<std::uint8_t> result =
      wood_by_axes<ConcurrencyTag>(scan, axes, is_used, paths, breast_height, options, state);
  for (const Index i : root)
    result[i] = 1;
  const Axis& axis = trunk();
  keep_around<ConcurrencyTag>(scan, axis, options.bare_reach, is_used, result);
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_SEPARATE_LEAVES_H
