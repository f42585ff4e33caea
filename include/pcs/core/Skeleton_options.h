// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of `extract_tree_skeleton()`: all types that a caller passes as named
// parameters.

#ifndef PCS_CORE_SKELETON_OPTIONS_H
#define PCS_CORE_SKELETON_OPTIONS_H

#include <cstddef>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! height above the root of the diameter at breast height (DBH) [m]
constexpr double default_breast_height = 1.3;
//! \ingroup PkgPcsSkeletonRef
//! divergence of the beam of common terrestrial scanners [rad]
constexpr double default_beam_width = 0.0003;

//! \ingroup PkgPcsSkeletonRef
//! how branches are found
enum class Skeleton_method {
  automatic, ///< `level_sets` if the plant has leaf blades, otherwise `chains`
  chains,    ///< axes are fitted to chains of geodesic level-set components
  sections,  ///< as published: cross-sections at centers of curvature, and spanning trees elsewhere
  level_sets ///< centers of geodesic level sets, for plants with leaf blades such as maize
};

//! \ingroup PkgPcsSkeletonRef
//! whether leaf points are removed
enum class Leaf_removal {
  where_found, ///< if leaves are detected
  always,
  never
};

//! \ingroup PkgPcsSkeletonRef
//! how a section is fitted
enum class Section_fit {
  conic,   ///< least-squares conic with constant term 1, as published
  ellipse, ///< direct ellipse fit of Halir and Flusser; never a hyperbola
  circle,  ///< Taubin's circle fit; accurate on short arcs
  by_arc   ///< an ellipse if nearly the whole cross-section is visible, otherwise a circle
};

/// A conic has five degrees of freedom [count].
constexpr std::size_t fewest_points_of_section = 6;

/*!
  \ingroup PkgPcsSkeletonRef
  \brief options of `Skeleton_method::sections`.

  The defaults are those of section 3.7 of \cite aiteanu2022, which gives no value for the distance
  of dense points and for the exponent of sparse branches.
*/
struct Slice_options
{
  Section_fit fit = Section_fit::conic;
  double height = 5;              ///< height of a slice, in spacings [-]
  bool is_height_local = false;   ///< whether local spacings replace the median spacing
  double radius = 1;              ///< radius of a slice, in radii of curvature [-] ...
  double radius_offset = 0;       ///< ... and an addition to it, in spacings [-]
  std::size_t lowest_count = 10;  ///< smallest number of points of a slice [count]
  std::size_t highest_count = 20; ///< larger slices are sampled at random; 0: no limit [count]
  double upright = 0.9;           ///< ratio of the half axes below which a slice is tilted [-]
  int tilts = 5;                  ///< largest number of tilts [count]
  bool do_mark_support = true;    ///< whether points that agree with a section are skipped
  double support_radius = 0.35;   ///< relative difference of the radii that counts as agreement [-]
  double support_cosine = 0.9;    ///< cosine of the angle between the axes, likewise [-]
  double largest_radius = 200;    ///< largest radius of a candidate center, in spacings [-]
  unsigned seed = 0;              ///< of the random sample
  bool has_normals = false;       ///< whether `normal_map` has normals of the input, to be used
  double turn_cost = 0;           ///< relative cost of a joint across the axes of sections [-]
  //! largest distance of dense points from the surface between two sections: the sum of this
  //! fraction of the radius [-] ...
  double dense_radius = 0.25;
  double dense_offset = 2; ///< ... and this number of spacings [-]
  //! exponent of the radii of sparse branches, as a function of the length beyond; 1/2: da Vinci's
  //! rule [-]
  double allometry = 0.4;
};

} // namespace pcs

#endif // PCS_CORE_SKELETON_OPTIONS_H
