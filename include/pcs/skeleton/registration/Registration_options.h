// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the registration of scanner stations.

#ifndef PCS_SKELETON_REGISTRATION_REGISTRATION_OPTIONS_H
#define PCS_SKELETON_REGISTRATION_REGISTRATION_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace skeleton {

/// Options of the search for scan grids. Lengths are in the local unit of the scan.
struct Scan_grid_options
{
  double nearest = 0.8,
         farthest = 30;  ///< horizontal distance of a station from the centre of the scan [L]
  double spacing = 0.06; ///< spacing of candidate positions, relative to their distance [-]
  double shortest = 0.8, longest = 4; ///< distance between beams, in point spacings [-]
  double hint = 3.2;                  ///< least score of a candidate direction, in deviations [-]
  double evidence = 5;                ///< least contrast of a detection, in standard deviations [-]
  double significance = 3;            ///< the same if only few hypotheses are tested [-]
  double least_contrast = 0.01;       ///< least mean cosine for the curvature [-]
  double tilt = 0.02;                 ///< standard deviation of the tilt of scanners [rad]
  double far = 1.2;                   ///< largest distance of pairs in the fit of a grid [L]
  double least_share = 0.03;          ///< least fraction of the unassigned points for a station [-]
  std::size_t pairs = 6000;           ///< pairs drawn for each step of the search [count]
  std::size_t fewest_pairs = 500;     ///< least number of pairs for a reliable estimate [count]
  std::size_t samples = 10000;        ///< single points in the final fit [count]
  std::size_t guesses = 6;            ///< largest number of directions that are examined [count]
  std::size_t fewest = 1000;          ///< least number of points for a reliable search [count]
  std::size_t most = 40;              ///< largest number of stations [count]
  double loosest = 0.2;               ///< largest misfit of points of a station [steps]
};

/// Criteria for the points that are used to register stations, and standard deviations of the other
/// causes of their residuals.
struct Station_alignment_options
{
  double thickness = 3; ///< smallest radius, in units of the noise [-]
  std::size_t fewest =
      10; ///< least points of a piece; pieces are halved while both halves have as many [count]
  double longest = 32; ///< largest half length of a piece, in radii [-]
  //! error of a fitted radius or position, in units of the noise [-] ...
  double fit = 3;
  double relative_fit = 0.2;    ///< ... combined with an error in radii [-]
  double oval = 0.04;           ///< half difference of the semi-axes of a section, in radii [-]
  double largest_error = 4.685; ///< residual of weight 0, in noise (Tukey's constant) [-]
  //! prior standard deviation of the motions, in units of the noise [-]
  double motion = 1;
  //! error of the motions, relative to their size, above which more points are used [-] ...
  double agreement = 0.4;
  //! ... unless the motions are smaller than this, in units of the noise [-]
  double least = 0.25;
  std::size_t fewest_pieces = 8; ///< least pieces of every second axis for an error [count]
  //! size of the applied motions above which another draft follows, in units of the noise [-]
  double much = 1.5;
  int passes = 3; ///< largest number of drafts [count]
  int rounds = 6; ///< Gauss-Newton steps per estimate [count]
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
