// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What tells how stations must move.

#ifndef PCS_SKELETON_REGISTRATION_STATION_ALIGNMENT_OPTIONS_H
#define PCS_SKELETON_REGISTRATION_STATION_ALIGNMENT_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace skeleton {

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

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_STATION_ALIGNMENT_OPTIONS_H
