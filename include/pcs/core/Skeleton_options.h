// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of `extract_tree_skeleton()`: all types that a caller passes as named parameters.

#ifndef PCS_CORE_SKELETON_OPTIONS_H
#define PCS_CORE_SKELETON_OPTIONS_H

#include <cstddef>

namespace pcs {

/// How branches are found.
enum class Skeleton_method {
  chains, ///< whole axes are fitted to the layers of the paths from the root
  /// the dissertation: sections at centers of curvature, spanning trees where there are none
  sections
};

/// Whether points of leaves are looked for and left out.
enum class Leaf_removal {
  where_found, ///< where there is evidence of them
  always,
  never
};

/// How a section is fitted.
enum class Section_fit {
  conic,   ///< least squares for the conic with constant term 1; the dissertation's
  ellipse, ///< the direct fit of Halir and Flusser; never a hyperbola
  circle,  ///< Taubin's circle; right on short arcs
  by_arc   ///< an ellipse where nearly the whole turn is seen, else a circle
};

/// A conic has five degrees of freedom [count].
constexpr std::size_t fewest_points_of_section = 6;

/// The rules of section 3.7 of the dissertation; each may be replaced by ours.
struct Slice_options
{
  Section_fit fit = Section_fit::conic;
  double height = 5;              ///< of a slice, in spacings [-]
  bool is_height_local = false;   ///< multiples of the local spacing instead of the median
  std::size_t lowest_count = 10;  ///< points of a slice
  std::size_t highest_count = 20; ///< more are drawn at random; 0: all are used
  double upright = 0.9;           ///< ratio of the half axes below which a slice is tilted [-]
  int tilts = 5;                  ///< tries
  bool do_mark_support = true;    ///< points that agree with a section need none of their own
  double support_radius = 0.35;   ///< relative difference of the radii that is agreement [-]
  double support_cosine = 0.9;    ///< of the angle between the axes
  double largest_radius = 200;    ///< of a center candidate, in spacings [-]
  unsigned seed = 0;
};

} // namespace pcs

#endif // PCS_CORE_SKELETON_OPTIONS_H
