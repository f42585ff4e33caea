// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options, constants and result of an elastic solve.

#ifndef PCS_DEFORMATION_MODEL_ELASTIC_OPTIONS_H
#define PCS_DEFORMATION_MODEL_ELASTIC_OPTIONS_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/model/Elastic_network.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace pcs {

namespace deformation {

/// Largest ratio of the energy after a warm start to the energy of the last result; above it, the
/// start is cold. [-]
constexpr double largest_warm_growth = 2;

/// Weight of the local fit relative to the neighbours in the smoothing of rotations, at stiffness
/// 1, for a node with the fraction `1 / reference_size` of the surface. Chosen among 0.004 to 2 on
/// the bars, tubes and plates of benchmark/quality. Smaller values resist the bending by a dragged
/// handle, and with larger values surfaces buckle. [-]
constexpr double default_fit_weight = 0.3;
/// Size of a reference network: smoothing always extends over a few of its edges. Otherwise denser
/// sampling would make a body bend more easily. Chosen on the same cases, as a compromise between
/// uniform bending and short edges. [count]
constexpr double reference_size = 10000;
/// Largest area of a node in the weight of its local fit, in units of a node of the reference
/// network. Smaller networks are therefore stiffer: with a few hundred samples, rotations with
/// little smoothing would buckle. [-]
constexpr double largest_relative_area = 5;
constexpr double smallest_relative_area = 1e-9;
/// Iterations end when the energy decreases by less than this fraction. Smaller values do not make
/// the results of benchmark/quality more accurate. [-]
constexpr double default_tolerance = 0.05;
constexpr int default_maximal_number_of_passes = 20;
/// Damping of the single Newton step by which each iteration improves the rotations. Without
/// damping, iterations converge faster, but the coarsest networks fold under large twists. Chosen
/// on the same cases among 0 to 0.8. [-]
constexpr double fit_damping = 0.2;
/// The first accelerated iteration after a start from the rotation field of the handles. If the
/// field explains the motion, fewer iterations suffice. After a start from a guess, iterations are
/// accelerated as soon as two states are known.
constexpr int first_accelerated_pass = 4;
/// If an accelerated iteration reduces the energy by less than this fraction of the tolerance, a
/// plain iteration decides whether the iterations end. [-]
constexpr double poor_gain = 0.1;
/// Largest number of halvings of a step that raises the energy, for materials with a Poisson's
/// ratio. [count]
constexpr int most_halvings = 3;
/// A guess from a coarser network is accepted if its energy is below this fraction of the energy
/// after one iteration. The fraction is 0.95 or more if the field of the handles explains the
/// motion (bars and tubes of benchmark/quality). It is 0.03 to 0.8 for the plate, the bar bent
/// about two axes, and bodies with turned heads. [-]
constexpr double guess_advantage = 0.8;
/// Limits for the final energy of a network, as a fraction of its energy after the first iteration.
/// Below `sure_advantage`, the finer network accepts the guess untested; from `least_advantage` on,
/// the guess is discarded. In 150 drags of scanned bodies and the cases of benchmark/quality, no
/// guess was rejected below a fraction of 0.43, and none was accepted above 0.81. [-]
constexpr double sure_advantage = 0.35;
constexpr double least_advantage = 0.9;
/// Number of solves that determine the directions of the links under a guess, before its energy is
/// measured. [count]
constexpr int settling_solves = 3;

struct Elastic_options
{
  int maximal_number_of_passes = default_maximal_number_of_passes;
  double tolerance = default_tolerance;
  double stiffness = 1;     ///< resistance against bending relative to stretching [-]
  double poisson_ratio = 0; ///< transverse contraction under stretch, in [-1, 0.5] [-]
  Rotation_field rotation_field = Rotation_field::geodesic;
};

struct Elastic_result
{
  Status status = Status::nothing_to_do;
  int number_of_passes = 0;
  double energy = 0;         ///< [L^2]
  double initial_energy = 0; ///< after the first positions, before any iteration [L^2]
  /// After the first iteration if the start was the field of the handles, otherwise 0. [L^2]
  double first_pass_energy = 0;
  /// Whether the guess had clearly less energy than the field of the handles, on this or a coarser
  /// network.
  bool is_far_from_field = false;
};

/// Solution of a coarser network, interpolated at the first nodes of this network: deviations from
/// the field of the handles.
struct Deviation_guess
{
  std::vector<Vec3> deviations; ///< empty if the guess was discarded
  bool is_far_from_field =
      false; ///< clearly better than the field on the coarser network; accepted untested
  /// Offsets of positions by the interior links of coarser networks, for nodes of the coarser
  /// network; may be empty.
  std::vector<Vec3> link_offsets;
  /// The offset of a node of this network, interpolated from these; empty if there are none.
  std::function<Vec3(std::size_t)> link_offset;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_ELASTIC_OPTIONS_H
