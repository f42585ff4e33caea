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
  geodesic,  ///< along geodesics of the rotation group, for any number of turns
  quaternion ///< by linear blending and normalisation of unit quaternions, as published: up to
             ///< 360 degrees
};

//! \ingroup PkgPcsDeformationRef
//! how the samples nearest to a point are found
enum class Sample_search {
  regions,           ///< nearest samples among the adjacent geodesic regions and their
                     ///< neighbours
  breadth_first_hops ///< the samples with the fewest hops on the neighbour graph, as published
                     ///< (Algorithm 1)
};

//! \ingroup PkgPcsDeformationRef
//! weights of the samples of a point
enum class Sample_weights {
  compact,       ///< (1 - (d / d_{K+1})^2)^2: continuous, because a sample that leaves the K
                 ///< nearest has the weight 0
  inverse_square ///< 1 / d^2, as published (2.6): discontinuous where the nearest samples change
};

//! \ingroup PkgPcsDeformationRef
//! the state from which a solve starts
enum class Solver_start {
  cold, ///< the rest shape: the result depends only on it and on the motions of the handles
  warm  ///< the last result: fewer iterations if the handles have moved little since then
};

} // namespace pcs

#endif // PCS_CORE_DEFORMATION_OPTIONS_H
