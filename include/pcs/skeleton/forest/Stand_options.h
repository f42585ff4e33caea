// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of stem detection and tree segmentation.

#ifndef PCS_SKELETON_FOREST_STAND_OPTIONS_H
#define PCS_SKELETON_FOREST_STAND_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace skeleton {

/// Which points are looked at, and what a stem is. Lengths in breast heights unless said otherwise
/// [-].
struct Stand_options
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

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_STAND_OPTIONS_H
