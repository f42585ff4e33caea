// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Inferred wood that a scan does not show: branches, and volumes with intervals.

#ifndef PCS_GENERATORS_HIDDEN_WOOD_H
#define PCS_GENERATORS_HIDDEN_WOOD_H

#include <pcs/core/Tree_skeleton.h>

#include <cstddef>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsGeneratorsRef
//! an inferred volume
struct Inferred_volume
{
  double value = 0;              //!< expected volume [L^3]
  double standard_error = 0;     //!< [L^3]
  double least = 0, largest = 0; //!< interval of 95 % confidence [L^3]
};

/*!
  \ingroup PkgPcsGeneratorsRef
  \brief The result of `complete_hidden_wood()`: inferred wood, apart from the measured wood.

  `branches` is a graph of its own, without measured nodes. It may consist of several trees: node
  `v` without a parent is the base of a branch that begins at node `attached_to[v]` of the measured
  skeleton. It is one of many ways in which the hidden wood may look, with about the expected
  volume. `Tree_bundle::root` is the first base, and `Tree_bundle::branches` lists the branches with
  their orders in the whole tree; `Tree_branch::parent` is `npos` for branches on measured wood.
  `Tree_node::is_measured` is `false`.
*/
template <class Kernel>
struct Hidden_wood
{
  Tree_skeleton<Kernel> branches;
  //! for each node of `branches`: the node of the measured skeleton that it begins at, or `npos`
  std::vector<std::size_t> attached_to;
  std::size_t number_of_stems = 0; //!< the first branches, which continue stems [count]

  double measured_volume = 0;      //!< of the skeleton, the sum of its frusta [L^3]
  Inferred_volume hidden_branches; //!< branches in places that few beams reach
  Inferred_volume missing_stems;   //!< thick axes that a gap of the pipe model shows
  //! change of the volume of measured axes that are partly hidden; it may be negative
  Inferred_volume radius_correction;
  Inferred_volume inferred_volume; //!< the sum of the three
  //! measured and inferred; the interval includes errors of the measured wood
  Inferred_volume total_volume;

  //! share of the crown that less than a tenth of the beams reaches, where the crown is the
  //! measured wood, rotated about the trunk [-]
  double hidden_crown_share = 0;
  double density_factors[3] = {1, 1, 1}; //!< of branches on stems, on branches and on twigs [-]
  double angular_step = 0;               //!< between beams, given or estimated [rad]
  //! share of the returns whose next return is in a direction at `angular_step`, within a tenth;
  //! the smallest of all stations, by samples. It is near 1 for a complete scan on a grid of beams,
  //! and below 0.5 if the scan is thinned, or a position of a scanner or the angle is wrong [-]
  double grid_share = 0;
  //! share of the length of the measured axes with returns beside them. It is small if the skeleton
  //! is not of this scan, or has other coordinates [-]
  double scanned_share = 0;
};

} // namespace pcs

#endif // PCS_GENERATORS_HIDDEN_WOOD_H
