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

/*!
  Options of the fit of one chain (`Chain_fit`). Factors of the spacing unless stated otherwise [-].

  With the spacing `u` [L], the noise `s` [L] and the point density `D` [1/L^2], a point at the
  distance `x` [L] from an axis, which has the radius `r` [L] there, is

  - gathered for the fit if `x <= gather_factor r + gather_offset u`;
  - explained by the axis if `x <= r + max(cover_offset u, cover_factor r)`;
  - inside the axis if `x < r - max(filled_noise s, filled_depth r)`.

  A section of length `h` [L] is expected to have `2 pi r h D` points. `Axis_fit` minimises the
  residuals of the gathered points, with the priors of `expect_sections()`, until no node changes by
  `settled s`. Radii are then reduced to `max(r / 2, sqrt(r^2 - noise_share s^2))`. The axis is
  accepted if it explains the fraction `explained` of its own points, and if it has a node

  - at a distance of at least `(1 + protrusion_radius) R + protrusion u` from the nearest other
    axis, which has the radius `R` [L], or
  - without points of other axes within `protrusion u`.

  An axis other than the first is rejected if more than the fraction `enclosed` of all points on or
  inside it lies inside its thick sections, `r >= max(thick u, hollow s)`: a scan has the surface of
  wood only, so the axis encloses other branches or leaves. Short sections around forks are kept.
*/
struct Chain_options
{
  Node_spacing node_spacing{0.6, 2, 8}; ///< distance of nodes in radii; bounds in spacings
  double gather_factor = 1.25;          ///< distance within which points are gathered, in radii ...
  double gather_offset = 1.7;           ///< ... plus this many spacings
  double cover_factor = 0.15;           ///< points up to this many radii outside are explained ...
  double cover_offset = 1.1;            ///< ... or up to this many spacings
  double explained = 0.4;         ///< least fraction of its own points that a chain explains [-]
  double protrusion = 3;          ///< least protrusion of an axis from existing ones ...
  double protrusion_radius = 0.3; ///< ... plus this many radii of the existing axis
  int sectors = 5;                ///< least number of sectors, of 12, with points on a circle
  double circle_deviation = 0.25; ///< largest deviation of points from such a circle, in radii
  double circle_noise = 2.5;      ///< least radius of such a circle, in noise
  double expected_share =
      0.25; ///< circles with a smaller fraction of the expected points straddle several twigs [-]
  //! standard deviation of a counted radius, in fitted radii and in spacings
  double prior_share = 0.5, prior_offset = 0.2;
  double prior_ratio = 2.5; ///< largest credible ratio of fitted to counted radii [-]
  double blurred = 4; ///< radius, in noise, below which noise hides the curvature of a section [-]
  //! largest factor by which occlusion reduces the counts of such sections along an axis [-]
  double most_hidden = 2;
  double hidden_nodes = 20; ///< number of nodes that halves the logarithm of this factor
  //! taper while no density is known: the median radius within the first fraction of the length
  //! decreases linearly to the second fraction of this radius at the tip [-]
  double taper_from = 1.0 / 3, taper_to = 0.5;
  double taper_share = 0.25; ///< standard deviation of that radius, in radii near the base [-]
  double taper_count = 24;   ///< number of points above which this deviation increases [count]
  //! standard deviation of the mean of the points of a thin branch from its expected position:
  //! multiple of the deviation of the visibility field, in radii [-] ...
  double facing_share = 5;
  double facing_noise = 0.5; ///< ... plus this multiple of the noise [-]
  //! least length of the mean normal [-] and number of points [count] for radii by width
  double width_one_sided = 0.6, width_count = 6;
  double width_radius = 8;                  ///< largest radius to which this applies, in spacings
  double width_factor = 1.7320508075688772; ///< radius / standard deviation of the points [-]
  //! standard deviation of a radius by width, in radii and in noise [-]
  double width_share = 0.15, width_noise = 0.5;
  double visible = 0.5; ///< least visible fraction of a section for counting its points [-]
  //! fraction of the expected points below which another axis may hide a section [-]
  double counted_share = 0.7;
  double hiding_radius = 4; ///< search radius for such an axis, in radii ...
  double hiding_offset = 6; ///< ... plus spacings
  double noise_share = 0.2; ///< r^2 is reduced by this many noise^2: noise inflates thin branches
  double thick = 4;         ///< least radius of branches that are extended beyond their tips
  double filled = 0.08; ///< thick axes end where a larger fraction of the points lies inside [-]
  //! least radius of thick axes that widen farther out, and least ratio of this widening [-]
  double thick_widening = 2, widening = 1.1;
  double bush = 0.2;         ///< largest fraction of interior points in sampled sections [-]
  double typical = 0.5;      ///< least density of such sections, relative to the median [-]
  double filled_depth = 0.1; ///< points lie inside if they are deeper than this many radii ...
  double filled_noise = 4;   ///< ... and than this multiple of the noise
  double hollow = 12;        ///< radius, in noise, at which a hollow interior is recognized [-]
  double enclosed = 0.25; ///< largest fraction of points inside thick sections, also of others [-]
  double deep = 0.3;      ///< upper bound on the depth of flutes of a stem, in radii
  double steady = 4;      ///< length of the stretches that define the thickness, in radii
  double thin_base = 0.4,
         thick_base =
             0.75; ///< axes thinner than the first fraction at the base begin at the second [-]
  int most_skipped = 3; ///< largest gap in a thick axis (whorls), in trial extensions [count]
  double extension = 3; ///< trial extension at both ends, in radii ...
  double extension_offset = 4;          ///< ... plus spacings
  double extension_share = 0.3;         ///< least fraction of the expected points on an extension
  std::size_t lowest_count = 2;         ///< least number of points of an axis [count]
  int narrowing = 5;                    ///< iterations in which wide weights narrow [count]
  int fewest = 3, most_iterations = 40; ///< bounds on the iterations of a fit [count]
  //! largest change at which a fit ends, in units of the noise [-]
  double settled = 0.3;
  int full_iterations = 2; ///< final iterations with more points; none with wide weights [count]
  std::size_t enough = 16,
              full_enough = 256; ///< points per node in first and in final iterations [count]
  Oval_options ovals;
};

/// Axis that is not yet accepted.
struct Candidate
{
  Axis axis;                           ///< empty if none was found
  std::vector<Index> points, segments; ///< explained points in increasing order, and their segments
  std::size_t number_of_own_points = 0;
  std::vector<double> deviations;
  std::vector<Density_sample> densities;
};

/// Input of the fit of a chain. The referenced objects outlive the fit.
struct Chain_view
{
  const Scan& scan;
  const Axis_set& set;
  const Chain_options& rules;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_CHAIN_OPTIONS_H
