// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the registration of scanner stations.

#ifndef PCS_SKELETON_REGISTRATION_REGISTRATION_OPTIONS_H
#define PCS_SKELETON_REGISTRATION_REGISTRATION_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace skeleton {

/// Lengths are in units of the scan.
struct Scan_grid_options
{
  double nearest = 0.8,
         farthest = 30;  ///< horizontal distance of a station from the middle of the scan [L]
  double spacing = 0.06; ///< of the places that are tried, by their distance [-]
  double shortest = 0.8, longest = 4; ///< distance between beams, by that of the points [-]
  double hint = 3.2;            ///< deviations above what is usual, of what is looked at again [-]
  double evidence = 5;          ///< standard deviations above what is usual [-]
  double significance = 3;      ///< the same where little is tried [-]
  double least_contrast = 0.01; ///< mean cosine [-]
  double tilt = 0.02;           ///< of scanners, standard deviation [rad]
  double far = 1.2;             ///< distance of points that tell the grid of a whole tree [L]
  double least_share = 0.03;    ///< of the points that have no station yet [-]
  std::size_t pairs = 6000;     ///< that are looked at [count]
  std::size_t fewest_pairs = 500; ///< that can tell [count]
  std::size_t samples = 10000;    ///< single points [count]
  std::size_t guesses = 6;        ///< that are followed [count]
  std::size_t fewest = 1000;      ///< points that can tell [count]
  std::size_t most = 40;          ///< stations [count]
  double loosest = 0.2;           ///< points of a station are this near to whole numbers [steps]
};

/// Which points tell where stations are, and what else their distances from the axes may come from.
struct Station_alignment_options
{
  double thickness = 3; ///< smallest radius, in noise [-]
  std::size_t fewest =
      10; ///< points of a piece of a branch, which are halved as long as both have them [count]
  double longest = 32;          ///< half of the length of a piece, in radii [-]
  double fit = 3;               ///< error of a radius or place that was fitted, in noise ... [-]
  double relative_fit = 0.2;    ///< ... and in radii [-]
  double oval = 0.04;           ///< half difference of the half axes of a section, in radii [-]
  double largest_error = 4.685; ///< of a point, in noise (Tukey's constant) [-]
  double motion = 1;            ///< usual size, in noise [-]
  //! error of motions, by their size, above which more points are looked at ...
  double agreement = 0.4;
  double least = 0.25;           ///< ... unless the motions are as small as this, in noise [-]
  std::size_t fewest_pieces = 8; ///< of every second axis that tell the error [count]
  //! motions that are looked for once more when they are taken out, in noise [-]
  double much = 1.5;
  int passes = 3; ///< of these, at most
  int rounds = 6; ///< of each
};

/// Options of `register_stations()`.
struct Registration_options
{
  Scan_grid_options scan_grids;
  Station_alignment_options alignment;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_REGISTRATION_OPTIONS_H
