// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Statistics of a skeletonization: counts, sizes of the tree and their standard errors, seconds.

#ifndef PCS_CORE_SKELETON_REPORT_H
#define PCS_CORE_SKELETON_REPORT_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/core/Status.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! sums over a part of a tree
struct Branch_totals
{
  std::size_t number_of_branches = 0; ///< [count]; 0 in size classes, which may split branches
  double length = 0;                  ///< along the axes [L]
  double volume = 0;                  ///< of the frusta between the nodes [L^3]
};

//! \ingroup PkgPcsSkeletonRef
//! a scanner station and the estimated rigid motion that registers its points with those of the
//! other stations
struct Scan_station
{
  long long label = 0;              ///< label in `station_map`, or the index of the station
  std::size_t number_of_points = 0; ///< points of the station [count]
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(); ///< translation of the mean of its points [L]
  double turn = 0;                                 ///< rotation about this mean [rad]
  //! position of the scanner; only set if its scan grid was found [L]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  //! angles between columns and between rows of beams; 0: no search for scan grids [rad]
  double azimuth_step = 0, elevation_step = 0;
};

//! \ingroup PkgPcsSkeletonRef
//! estimated values of a tree, or their standard errors
struct Tree_values
{
  double height = 0;                    ///< [L]
  double diameter_at_breast_height = 0; ///< [L]
  double trunk_length = 0;              ///< [L]
  double length = 0;                    ///< of the branches that were scanned at all [L]
  double volume = 0;                    ///< of all branches [L^3]
  double trunk_volume = 0;              ///< [L^3]
  std::vector<double> volume_by_size;   ///< of the classes in `Skeleton_report::by_size` [L^3]
};

/*!
  \ingroup PkgPcsSkeletonRef
  \brief standard deviations of a skeleton among resampled copies of its scan.

  The skeleton itself counts like a copy if the copies have at least half of the points of the scan.
  See `number_of_resamples` of `Tree_skeletonization`. Copies of small scans share most of their
  points, so the deviations are too small; copies of large scans are thinned, so they tend to be too
  large. `standard_errors()` takes both into account.
*/
struct Skeleton_spread
{
  std::size_t number_of_copies = 0;       ///< copies with a tree; 0: not estimated [count]
  std::size_t number_of_empty_copies = 0; ///< copies without a tree [count]
  std::size_t number_of_leafy_copies = 0; ///< copies with a tree from which leaves were removed
  //! whether the scan and its copies outvoted the scan on whether there are leaves, so that the
  //! skeleton was extracted again with their decision
  bool is_leaf_removal_changed = false;
  //! whether the skeleton is that of points displaced by a thousandth of the spacing, because the
  //! skeleton of the scan differed more from most of the copies
  bool is_displaced = false;
  double fraction = 0;                  ///< expected fraction of the points in a copy [-]
  double height = 0;                    ///< [L]
  double diameter_at_breast_height = 0; ///< [L]
  double trunk_length = 0;              ///< [L]
  double length = 0;                    ///< of all branches [L]
  double volume = 0;                    ///< of all branches [L^3]
  double trunk_volume = 0;              ///< [L^3]
  std::vector<double> volume_by_size;   ///< of the classes in `Skeleton_report::by_size` [L^3]
  double root = 0; ///< root mean square distance of the roots from their mean [L]
};

//! \ingroup PkgPcsSkeletonRef
//! statistics of `extract_tree_skeleton()` or `Tree_skeletonization`
struct Skeleton_report
{
  //! `converged`; `nothing_to_do` if no branch was found; `cancelled`
  Status status = Status::nothing_to_do;
  Skeleton_method method = Skeleton_method::chains; ///< that was used; never `automatic`

  std::size_t number_of_points = 0; ///< of the input [count]
  //! points that coincide with another point within the noise; in dense scans, these are all points
  //! that are merged with others of their cell [count]
  std::size_t number_of_duplicates = 0;
  //! points from which the tree is computed, `number_of_points - number_of_duplicates`; the
  //! following numbers of points count these [count]
  std::size_t number_of_scan_points = 0;
  //! side of the cells in which the points of a dense scan were merged; 0: not a dense scan [L]
  double merging_cell = 0;
  std::size_t number_of_outliers = 0; ///< removed points far from all others [count]
  //! points removed by `wood_map` or `do_remove_leaves` [count]
  std::size_t number_of_leaf_points = 0;
  std::size_t number_of_ground_points = 0; ///< points removed as ground [count]
  //! points removed as objects that stand on the ground beside the tree, such as posts and shrubs
  //! [count]
  std::size_t number_of_object_points = 0;
  //! axes of such objects that are near the tree or touch it [count]
  std::size_t number_of_standing_branches = 0;
  std::size_t number_of_wall_points = 0; ///< points removed as walls or other flat faces [count]
  std::size_t number_of_unexplained_points = 0; ///< other points not assigned to a branch [count]
  //! those of them around the base of a thick branch that no thick wood joins to the tree [count]
  std::size_t number_of_unexplained_thick_points = 0;
  //! points of branches too far from the tree, which are not part of the result [count]
  std::size_t number_of_unreached_points = 0;
  std::size_t number_of_unreached_branches = 0; ///< branches too far from the tree [count]
  //! further stems at the height of the root, unconnected or connected by a branch, which are
  //! interpreted as other trees [count]
  std::size_t number_of_other_stems = 0;
  //! whether the points lie in sparse rows, in which leaves cannot be separated; all are kept
  bool is_in_rows = false;
  //! stations whose points were moved; empty if no stations were found
  std::vector<Scan_station> stations;
  //! largest station shift that was estimated but rejected, because it is too large for an error of
  //! registration or a station has too few points; 0: none [L]
  double rejected_station_shift = 0;
  //! whether the stations of this shift were detected by their scan grids, not given
  bool is_rejected_station_detected = false;
  std::size_t number_of_nodes = 0;    ///< [count]
  std::size_t number_of_branches = 0; ///< [count]

  double spacing = 0; ///< median distance to the nearest neighbour [L]
  //! estimated voxel size of a thinned scan, for which the radii are corrected; 0: not thinned [L]
  double voxel_size = 0;
  //! step to which the input coordinates are rounded, the largest of the three axes; 0: none [L]
  double coordinate_step = 0;
  //! whether `coordinate_step` is the resolution of 32-bit floating-point numbers far from the
  //! origin
  bool is_single_precision = false;
  //! standard deviation of the points from the surface; in dense scans, of the merged points [L]
  double noise = 0;
  //! median distance of the points from the fitted surfaces; several times `noise` indicates a
  //! poor fit [L]
  double residual = 0;
  double density = 0; ///< points per surface area of the branches; 0: unknown [1/L^2]
  //! fraction of the scanned area on leaf blades, if these decided on the method; otherwise 0 [-]
  double blade_fraction = 0;

  //! from the root along the up direction to the highest node, or to the highest leaves if leaves
  //! were found in the scan; leaves labelled by `wood_map` do not count [L]
  double height = 0;
  //! height of the root above the lowest points of the tree, leaves included [L]
  double root_elevation = 0;
  bool is_root_given = false;     ///< whether `root_position` was given
  bool is_skeleton_given = false; ///< whether `given_skeleton` was given
  double max_root_distance = 0;   ///< from the root to the farthest node [L]
  //! angle between the up direction and the main direction of the wood from thick to thin: pi / 2
  //! for a lying tree, pi for a tree that is upside down; 0 if no direction prevails [rad]
  double inclination = 0;
  //! inferred length of the trunk at the top of the tree, where leaves hide it; 0: none was
  //! inferred [L]
  double hidden_trunk_length = 0;
  double hidden_trunk_volume = 0; ///< of this part [L^3]
  //! diameter of the thickest stem at breast height, from a line fitted to its radii between 1.1
  //! and 1.5 m to reduce the effect of bark and noise; 0: the tree is lower [L]
  double diameter_at_breast_height = 0;
  //! diameters of all stems at breast height, thickest first; several if the trunk forks below [L]
  std::vector<double> stem_diameters;
  double breast_height = 0; ///< height of the measured diameters above the root [L]
  Branch_totals total;
  std::vector<Branch_totals> by_order; ///< trunk first
  //! upper bounds of the radii of the classes in `by_size`; the last class has no upper bound
  std::vector<double> size_bounds;
  std::vector<Branch_totals> by_size; ///< thinnest class first
  /*!
    Best estimates of the values of the tree. With resampled copies that have at least half of the
    points, they are medians of the values of the scan, the copies and displaced points. They differ
    less between nearly equal scans than the values of a single skeleton, which are the other
    members of this report. Without such copies, they equal these.
  */
  Tree_values estimates;
  Skeleton_spread spread; ///< standard deviations among resampled copies

  //! wall-clock time of each stage [s]
  struct Seconds
  {
    double neighbors = 0, paths = 0, axes = 0, joints = 0, sections = 0;
  } seconds;
};

namespace internal {

/*!
  Returns the ratio of the standard error of the whole scan to the standard deviation among subsets
  with a fraction f of the points. It is sqrt(f / (1 - f)), as for the delete-d jackknife [Shao, Wu
  1989], but at least 1, since decisions by chance do not improve with more points.
*/
inline double jackknife_factor(double fraction)
{
  return fraction > 0 && fraction < 1 ? std::max(1.0, std::sqrt(fraction / (1 - fraction))) : 1;
}

/// Returns the values of the skeleton alone.
inline Tree_values values_of_skeleton(const Skeleton_report& r)
{
  Tree_values v;
  v.height = r.height;
  v.diameter_at_breast_height = r.diameter_at_breast_height;
  v.length = r.total.length;
  v.volume = r.total.volume;
  if (!r.by_order.empty()) {
    v.trunk_length = r.by_order.front().length;
    v.trunk_volume = r.by_order.front().volume;
  }
  for (const Branch_totals& size : r.by_size)
    v.volume_by_size.push_back(size.volume);
  return v;
}

} // namespace internal

/*!
  \ingroup PkgPcsSkeletonRef
  \brief returns the standard errors of the estimates of a report: differences from the true tree.

  For about 95 % of the trees, the true value lies within two standard errors. The error e of an
  estimate v with the standard deviation s among the resampled copies is
  \f$ e^2 = (k s)^2 + (b v)^2 \f$. The first term is the effect of chance, where k is the factor of
  the delete-d jackknife for the fraction of points in a copy. The second term holds errors that all
  copies share, such as occluded wood; b was calibrated on 139 virtual scans of all habits with 1 to
  6 stations and with or without leaves, see `benchmark/results/skeletons.md`. To the errors of
  volumes, half of the volume of a hidden trunk is added in the same way.

  \return errors of 0, and no size classes, if the report has fewer than two copies
*/
inline Tree_values standard_errors(const Skeleton_report& r)
{
  constexpr double shared_by_size[] = {2.2, 0.44, 0.24, 0.22, 0.032}; // thinnest class first [-]
  Tree_values result;
  const Skeleton_spread& s = r.spread;
  const Tree_values& v = r.estimates;
  if (s.number_of_copies < 2 || r.by_order.empty())
    return result;
  const double factor = internal::jackknife_factor(s.fraction);
  const auto error = [factor](double deviation, double value, double shared) {
    return std::hypot(factor * deviation, shared * value);
  };
  result.height = error(s.height, v.height, 0.0086);
  result.diameter_at_breast_height =
      error(s.diameter_at_breast_height, v.diameter_at_breast_height, 0.016);
  result.trunk_length = error(s.trunk_length, v.trunk_length, 0.021);
  result.length = error(s.length, v.length, 0.21);
  const double hidden = 0.5 * r.hidden_trunk_volume;
  result.volume = std::hypot(error(s.volume, v.volume, 0.076), hidden);
  result.trunk_volume = std::hypot(error(s.trunk_volume, v.trunk_volume, 0.022), hidden);
  for (std::size_t k = 0; k < std::min(s.volume_by_size.size(), v.volume_by_size.size()); ++k)
    result.volume_by_size.push_back(error(s.volume_by_size[k],
                                          v.volume_by_size[k],
                                          shared_by_size[std::min<std::size_t>(k, 4)]));
  return result;
}

inline std::ostream& operator<<(std::ostream& out, const Skeleton_report& r)
{
  out << "status " << r.status << ", " << r.number_of_points << " points ("
      << r.number_of_duplicates << " duplicates, " << r.number_of_outliers << " outliers, "
      << r.number_of_leaf_points << " leaves, " << r.number_of_ground_points << " on the ground, "
      << r.number_of_object_points << " on objects beside the tree, " << r.number_of_wall_points
      << " on walls, " << r.number_of_unexplained_points << " unexplained, "
      << r.number_of_unexplained_thick_points << " of them on thick branches, "
      << r.number_of_unreached_points << " out of reach), " << r.number_of_other_stems
      << " other stems, " << r.number_of_branches << " branches, " << r.number_of_nodes
      << " nodes, spacing " << r.spacing << ", noise " << r.noise << ", residual " << r.residual
      << ", height " << r.height << ", diameter at breast height " << r.diameter_at_breast_height
      << ", length " << r.total.length << ", volume " << r.total.volume << "; seconds: neighbors "
      << r.seconds.neighbors << ", paths " << r.seconds.paths << ", axes " << r.seconds.axes
      << ", joints " << r.seconds.joints << ", sections " << r.seconds.sections;
  return out;
}

} // namespace pcs

#endif // PCS_CORE_SKELETON_REPORT_H
