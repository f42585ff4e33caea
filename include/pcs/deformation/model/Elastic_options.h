// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options, constants and result of an elastic solve.

#ifndef PCS_DEFORMATION_MODEL_ELASTIC_OPTIONS_H
#define PCS_DEFORMATION_MODEL_ELASTIC_OPTIONS_H

#include <pcs/core/Deformation_options.h>
#include <pcs/core/Status.h>
#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/solver/rotation_field.h>

#include <vector>

namespace pcs {

namespace deformation {

/// A warm start that has more than this times the energy of the last result is a cold one.
constexpr double largest_warm_growth = 2;

/// Weight of the local fit against its neighbours' when rotations are smoothed, at stiffness 1, of
/// a node that represents one part in `reference_size` of the surface. [-]
/// Chosen among 0.004 ... 2 on the bars, tubes and plates of benchmark/quality: smaller values hold
/// back bending that a dragged handle asks for, larger ones let surfaces buckle.
constexpr double default_fit_weight = 0.3;
/// Smoothing reaches a few edges of a network of so many nodes, whatever the size of the network:
/// otherwise a body would bend the more easily the denser its points. Chosen on the same cases,
/// where it trades even bends for short edges.
constexpr double reference_size = 10000;
/// Networks of fewer nodes than one in this many of it bend the more stiffly: with a few hundred
/// samples, rotations that are hardly smoothed would buckle.
constexpr double largest_relative_area = 5;
constexpr double smallest_relative_area = 1e-9;
/// Passes end when the energy falls by less than this fraction. Smaller values bring the cases of
/// benchmark/quality no nearer to their exact shapes. [-]
constexpr double default_tolerance = 0.05;
constexpr int default_maximal_number_of_passes = 20;
/// Each pass turns nodes towards their best rotation by one damped step of Newton's method. Without
/// damping, passes converge faster, and the coarsest networks fold up under large twists. Chosen on
/// the same cases among 0 ... 0.8.
constexpr double fit_damping = 0.2;
/// Passes are accelerated from this one on if they start from the field of the handles: where that
/// explains the motion, fewer are needed. Those that start from a guess are accelerated as soon as
/// two states are known.
constexpr int first_accelerated_pass = 4;
/// An accelerated pass that gains less than this fraction of the tolerance may have been a poor
/// proposal: a plain one decides whether there is more to gain. [-]
constexpr double poor_gain = 0.1;
/// A guess from a coarser network is taken if it has less than this fraction of the energy after
/// one pass. Where the field of the handles explains the motion, on the bars and tubes of
/// benchmark/quality, it has .95 or more; on the plate, the bar bent about two axes and bodies with
/// turned heads .03 to .8. [-]
constexpr double guess_advantage = 0.8;
/// A network that lowered the energy of its own first pass to less than the first fraction need not
/// have its guess tried on the finer one, nor one that left more than the second: the finer one
/// would find the same. Of 150 drags of scanned bodies and of the cases of benchmark/quality, no
/// guess was refused below a fraction of .43 and none was taken above .81. [-]
constexpr double sure_advantage = 0.35;
constexpr double least_advantage = 0.9;
/// Solves in which the links of a network find their directions under a guess, before its energy is
/// measured.
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
  double initial_energy = 0; ///< after the first positions, before any pass [L^2]
  /// After the first pass if the passes started from the field of the handles, otherwise 0. [L^2]
  double first_pass_energy = 0;
  /// Whether the guess turned out clearly better than the field of the handles, here or on a
  /// coarser network.
  bool is_far_from_field = false;
};

/// Solution of a coarser network, for the first nodes of this one: deviations from the field of the
/// handles.
struct Deviation_guess
{
  std::vector<Vec3> deviations; ///< empty if they are not worth a trial
  bool is_far_from_field =
      false; ///< clearly better than the field there, which need not be tried again
  std::vector<Vec3>
      /// offsets of positions by the interior links of coarser networks; may be empty
      link_offsets;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_ELASTIC_OPTIONS_H
