// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of stem detection and tree segmentation.

#ifndef PCS_SKELETON_FOREST_STAND_OPTIONS_H
#define PCS_SKELETON_FOREST_STAND_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace skeleton {

/// Criteria for the detection of stems and trees. Lengths are in breast heights unless stated
/// otherwise [-].
struct Stand_options
{
  double cell = 0.0155;          ///< voxel size of thinning: one point per voxel
  std::size_t solid_part = 30;   ///< smallest connected component of ground or trees [count]
  double ground_cell = 1;        ///< side of the squares whose lowest point is ground
  double ground_slope = 0.6;     ///< ... largest slope of the ground from this point [-]
  double ground_around = 0.75;   ///< radius around a foot in which its ground is measured ...
  std::size_t ground_points = 5; ///< ... from at least so many points [count]
  double rise = 0.5;             ///< least rise of a stem ...
  double steep = 0.5;            ///< ... and least rise per length [-]
  double stout = 4;              ///< least rise, in lower radii [-]
  double taper = 0.6;            ///< least ratio of the lower to the upper radius of a stem [-]
  double thinnest = 0.01;        ///< least lower radius of a stem
  double foot = 1;               ///< highest foot above the ground ...
  double foot_radii = 20;        ///< ... and in radii of the stem [-]
  double stool_radii = 3;   ///< stems of one tree lie within this many radii of the thicker one,
  double stool = 0.1;       ///< ... plus this length,
  double lean = 1;          ///< ... plus this multiple of the height of the foot [-]
  double hidden = 0.2;      ///< a stem continues if its axis ends this far above its lowest points
  double root = 0.5;        ///< height of the lowest part of a stem, where its paths begin
  double base_radii = 1.25; ///< ground points this near to a foot belong to it, in radii [-]
  double coarser = 3;       ///< voxel size of the search for sparsely sampled stems, in `cell` [-]
  double sparse = 1.6;      ///< least relative spacing of sparse points [-]
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_STAND_OPTIONS_H
