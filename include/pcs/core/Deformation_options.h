// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of `deform_point_set()`: all types that a caller passes as named parameters.

#ifndef PCS_CORE_DEFORMATION_OPTIONS_H
#define PCS_CORE_DEFORMATION_OPTIONS_H

namespace pcs {

/// How the handles' rotations are blended over the points between them.
enum class Rotation_field {
  geodesic, ///< evenly along the rotation group, any number of turns (default)
  /// the dissertation's: unit quaternions blended linearly, then normalised; up to 360 degrees
  quaternion
};

/// How the nearest samples of a point are found.
enum class Sample_search {
  /// the nearest among the samples whose regions touch that of the point, or touch those (default)
  regions,
  breadth_first_hops ///< the dissertation's Algorithm 1: by number of hops on the neighbour graph
};

/// How much a sample moves a point.
enum class Sample_weights {
  /// (1 - (d / d_{K+1})^2)^2: zero where a sample leaves the K nearest, hence continuous (default)
  compact,
  inverse_square ///< the dissertation's (2.6): 1 / d^2, which jumps there
};

/// Where a solve begins.
enum class Solver_start {
  cold, ///< at the rest shape: the result depends on that and on the motions of the handles only
  warm  ///< at the last result, which takes fewer passes where the handles have moved little since
};

} // namespace pcs

#endif // PCS_CORE_DEFORMATION_OPTIONS_H
