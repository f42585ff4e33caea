// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The trees of a scan of several: where they stand, and whose every point is.

#ifndef PCS_SKELETON_FOREST_H
#define PCS_SKELETON_FOREST_H

#include <pcs/internal/progress.h>
#include <pcs/skeleton/Scan.h>
#include <pcs/skeleton/Session_hints.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// A tree in the coordinates of the input.
struct Standing_tree
{
  Vec3 foot = Vec3::Zero(); ///< on the axis of its thickest stem, where that begins
  double radius = 0;        ///< of that stem, the largest in its lowest part [L]
};

struct Forest
{
  std::vector<Standing_tree> trees; ///< thick ones first
  std::vector<Index> tree_of_input; ///< by point of the input; `none`: no tree's
};

/// Which points are looked at, and what a stem is. Lengths in breast heights unless said otherwise [-].
struct Forest_rules
{
  double cell = 0.0155; ///< one point is kept in every cube of this side
  std::size_t solid_part =
      30;                    ///< fewer points that hang together are no ground to stand on [count]
  double ground_cell = 1;    ///< side of the squares in which the lowest point is ground
  double ground_slope = 0.6; ///< ... from which it rises at most by this slope
  double rise = 0.5;         ///< by so much a stem rises at least ...
  double steep = 0.5;        ///< ... by this per length [-]
  double stout = 4;          ///< least rise in radii below [-]
  double taper = 0.6;        ///< least ratio of its radius below to that above [-]
  double thinnest = 0.01;    ///< least radius of it below
  double foot = 1;           ///< highest foot above the ground ...
  double foot_radii = 20;    ///< ... also in radii of the stem [-]
  double stool_radii = 3;    ///< stems nearer than this many radii of the thicker one,
  double stool = 0.1;        ///< ... this,
  double lean = 1;           ///< ... and this per height of the foot [-], are one tree
  double root = 0.5;         ///< height of the lowest part of a stem, where its paths begin
  double base_radii = 1.25; ///< of what was left out as ground, this lies on the foot of a stem [-]
  double coarser =
      3; ///< side of the cubes in which stems of few points are looked for, in `cell` [-]
  double sparse = 1.6; ///< points so much farther apart than the median of trees are few [-]
};

/*!
  Finds the trees of a scan. `input` is finite, with at least two different points. Returns `false` if the work was cancelled;
  `forest` is untouched then. O(n log n).
*/
template <class ConcurrencyTag>
bool find_trees(const std::vector<Vec3>& input,
                const Session_hints& hints,
                pcs::internal::Progress& progress,
                Forest& forest);

} // namespace skeleton
} // namespace pcs

#ifndef PCS_COMPILED_SKELETON
#include <pcs/skeleton/Forest_impl.h>
#endif

#endif // PCS_SKELETON_FOREST_H
