// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options, input and output of the fit of one chain.

#ifndef PCS_SKELETON_AXES_CHAIN_OPTIONS_H
#define PCS_SKELETON_AXES_CHAIN_OPTIONS_H

#include <pcs/skeleton/axes/Axis_oval.h>
#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Rules of the fit of one chain. Factors of the spacing unless said otherwise [-].
struct Chain_options
{
  Node_spacing node_spacing{0.6, 2, 8}; ///< the factor is of the radius
  double gather_factor = 1.25;          ///< points within this many radii ...
  double gather_offset = 1.7;           ///< ... and this many spacings are looked at again
  double cover_factor = 0.15;     ///< points this many radii outside of the surface are explained,
  double cover_offset = 1.1;      ///< ... or this many spacings
  double explained = 0.4;         ///< share of its own points that a chain must explain
  double protrusion = 3;          ///< how far an axis must leave those that are there
  double protrusion_radius = 0.3; ///< ... and this many radii of those
  int sectors = 5;                ///< of 12, that a circle must see to be a start
  double circle_deviation = 0.25; ///< largest deviation of such a circle in radii
  double circle_noise = 2.5;      ///< smallest radius of such a circle in noise
  double expected_share =
      0.25; ///< circles with fewer points than this share of the expected straddle several twigs
  //! standard deviation of the radius by counting, in radii that are found, and in spacings
  double prior_share = 0.5, prior_offset = 0.2;
  double prior_ratio = 2.5; ///< found radii so much larger than counted ones are not believed
  double blurred = 4; ///< noise hides the curvature of sections thinner than this much of it [-]
  //! their counts along a whole axis are low by at most this factor where something hides it, ...
  double most_hidden = 2;
  double hidden_nodes = 20; ///< ... half of which is believed of this many nodes [count]
  //! while no density is known, axes taper from their radius within this share of the length to
  //! such a share of it ...
  double taper_from = 1.0 / 3, taper_to = 0.5;
  double taper_share = 0.25; ///< ... with a deviation of so much of it [-]
  double taper_count = 24;   ///< ... and more where more points than this tell otherwise [count]
  //! deviation of the middle of the points of a thin branch from its place: this many times the
  //! usual one ...
  double facing_share = 5;
  double facing_noise = 0.5; ///< ... and this much noise
  //! where the mean normal of the points is longer than this, and there are so many, ...
  double width_one_sided = 0.6, width_count = 6;
  double width_radius = 8; ///< ... axes thinner than this have a radius by the width of the points,
  double width_factor = 1.7320508075688772; ///< ... this many times their deviation [-]
  //! standard deviation of that radius, in radii and noise [-]
  double width_share = 0.15, width_noise = 0.5;
  double visible = 0.5;       ///< share of a section that such a radius must be counted on [-]
  double counted_share = 0.7; ///< of the expected points: below, other axes may hide a section [-]
  double hiding_radius = 4;   ///< how far such an axis is looked for, in radii ...
  double hiding_offset = 6;   ///< ... and spacings
  double noise_share = 0.2;   ///< r^2 is reduced by this many noise^2: noise inflates thin branches
  double thick = 4;           ///< branches of at least this radius are followed beyond their tips
  double filled = 0.08; ///< thick axes end where more than this share of the points lies inside ...
  //! ... from a smaller radius on, if they widen beyond that place by this factor [-]
  double thick_widening = 2, widening = 1.1;
  double bush = 0.2;         ///< with such a share, a section tells nothing about surfaces [-]
  double typical = 0.5;      ///< ... nor with less than this share of the usual density
  double filled_depth = 0.1; ///< ... deeper than this many radii ...
  double filled_noise = 4;   ///< ... and than this many times the noise
  double deep = 0.3;         ///< flutes of a stem are less deep than this many radii
  double steady = 4;         ///< length of a stretch that shows how thick an axis is, in its radii
  double thin_base = 0.4,
         thick_base =
             0.75; ///< an axis with a base below the first share of that begins at the second [-]
  int most_skipped = 3; ///< extensions by which a thick axis may be lost, at a whorl for example
  double extension = 3; ///< how far both ends are prolonged on trial, in radii ...
  double extension_offset = 4;          ///< ... and spacings
  double extension_share = 0.3;         ///< share of the expected points that a prolongation needs
  std::size_t lowest_count = 2;         ///< points of an axis
  int narrowing = 5;                    ///< iterations in which wide weights become narrow
  int fewest = 3, most_iterations = 40; ///< of a fit, ...
  double settled = 0.3;    ///< ... which ends when nothing moves by more than this much noise [-]
  int full_iterations = 2; ///< the last of them, to many points, unless weights were wide
  std::size_t enough = 16,
              full_enough = 256; ///< points per node that the others and those use [count]
  Oval_options ovals;
};

/// An axis that is not yet accepted.
struct Candidate
{
  Axis axis;                           ///< empty: none
  std::vector<Index> points, segments; ///< what it explains, points in increasing order
  std::size_t number_of_own_points = 0;
  std::vector<double> deviations;
  std::vector<Density_sample> densities;
};

/// What the fit of a chain sees; all of it outlives the fit.
struct Chain_view
{
  const Scan& scan;
  const Axis_set& set;
  const Chain_options& rules;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_CHAIN_OPTIONS_H
