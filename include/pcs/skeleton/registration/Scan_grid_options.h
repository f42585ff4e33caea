// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Where stations are looked for, and what is evidence of one.

#ifndef PCS_SKELETON_REGISTRATION_SCAN_GRID_OPTIONS_H
#define PCS_SKELETON_REGISTRATION_SCAN_GRID_OPTIONS_H

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

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_SCAN_GRID_OPTIONS_H
