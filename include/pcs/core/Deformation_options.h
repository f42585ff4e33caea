// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of `deform_point_set()`: all types that a caller passes as named
// parameters.

#ifndef PCS_CORE_DEFORMATION_OPTIONS_H
#define PCS_CORE_DEFORMATION_OPTIONS_H

namespace pcs {

//! \ingroup PkgPcsDeformationRef
//! how the rotations of the handles are blended over the points between them
enum class Rotation_field {
  geodesic,  ///< evenly along the rotation group, for any number of turns
  quaternion ///< unit quaternions, blended linearly and normalised, as
             ///< published: up to 360 degrees
};

//! \ingroup PkgPcsDeformationRef
//! how the nearest samples of a point are found
enum class Sample_search {
  regions,           ///< nearest samples among the adjacent geodesic regions and their
                     ///< neighbours
  breadth_first_hops ///< by number of hops on the neighbour graph, as published
                     ///< (Algorithm 1)
};

//! \ingroup PkgPcsDeformationRef
//! weights of the samples of a point
enum class Sample_weights {
  compact,       ///< (1 - (d / d_{K+1})^2)^2: 0 where a sample leaves the K nearest,
                 ///< so continuous
  inverse_square ///< 1 / d^2, as published (2.6), which jumps there
};

//! \ingroup PkgPcsDeformationRef
//! start of a solve
enum class Solver_start {
  cold, ///< at the rest shape: the result depends on that and on the motions of
        ///< the handles only
  warm  ///< at the last result: fewer passes if the handles have moved little
        ///< since
};

} // namespace pcs

#endif // PCS_CORE_DEFORMATION_OPTIONS_H
