// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Statistics of a skeletonization: counts, sizes of the tree, seconds per stage.

#ifndef PCS_CORE_SKELETON_REPORT_H
#define PCS_CORE_SKELETON_REPORT_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/core/Status.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/unit_of_height.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <sstream>
#include <string>
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
  std::size_t number_of_wall_points = 0;   ///< points removed as walls or other flat faces [count]
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

  //! from the root to the highest node or leaf, along the up direction [L]
  double height = 0;
  //! height of the root above the lowest points of the tree, leaves included [L]
  double root_elevation = 0;
  bool is_root_given = false;   ///< whether `root_position` was given
  double max_root_distance = 0; ///< from the root to the farthest node [L]
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
  Skeleton_spread spread;             ///< standard deviations among resampled copies

  //! wall-clock time of each stage [s]
  struct Seconds
  {
    double neighbors = 0, paths = 0, axes = 0, joints = 0, sections = 0;
  } seconds;
};

namespace internal {

/// Formats `value` with three significant digits.
inline std::string short_text(double value)
{
  std::ostringstream out;
  out.precision(3);
  out << value;
  return out.str();
}

/// Adds warnings about the points of the scan.
inline void warn_of_points(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  constexpr double max_unreached = 0.05; // fraction of the points [-]
  constexpr double max_leaves = 0.5;     // fraction of the points without ground and walls [-]
  if (r.number_of_other_stems > 0)
    sentences.push_back("more than one tree: " + std::to_string(r.number_of_other_stems) +
                        " other stem(s) at the height of the foot; only one tree is kept "
                        "(root_position selects it)");
  const std::size_t points = r.number_of_points - r.number_of_duplicates;
  if (double(r.number_of_unreached_points) > max_unreached * double(points))
    sentences.push_back(std::to_string(r.number_of_unreached_points) + " of " +
                        std::to_string(points) +
                        " points belong to branches that are too far from the tree");
  if (r.number_of_unexplained_thick_points > 0)
    sentences.push_back("a part of a thick branch may be missing: " +
                        std::to_string(r.number_of_unexplained_thick_points) +
                        " points around its base belong to no branch");
  if (r.number_of_wall_points > 0)
    sentences.push_back(std::to_string(r.number_of_wall_points) +
                        " points on or beside walls or other flat faces were removed; similar "
                        "objects may remain among the branches");
  const double tree =
      double(points) - double(r.number_of_ground_points) - double(r.number_of_wall_points);
  if (double(r.number_of_leaf_points) > max_leaves * tree)
    sentences.push_back("most of the points are classified as leaves, which hide wood: radii and "
                        "volume may differ much between scans of the same tree");
  if (r.rejected_station_shift > 0)
    sentences.push_back("the stations would have to move by up to " +
                        short_text(r.rejected_station_shift) +
                        ", too far for an error of registration, or have too few points, so no "
                        "points were moved; check that the labels denote scanner stations, not "
                        "flight lines");
  if (r.is_in_rows)
    sentences.push_back("the points lie in sparse rows, in which leaves cannot be separated from "
                        "wood; all points are kept (do_remove_leaves(true) removes leaves)");
}

/// Adds warnings about the precision of the coordinates.
inline void warn_of_precision(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  constexpr double max_step = 0.5; // of the spacing: larger steps merge or displace neighbours [-]
  if (r.voxel_size > 0)
    sentences.push_back("the points are voxel centers of size " + short_text(r.voxel_size) +
                        "; branches that are not several times as thick are rough guesses");
  else if (r.coordinate_step > max_step * r.spacing)
    sentences.push_back(
        "the coordinates are rounded to steps of " + short_text(r.coordinate_step) +
        (r.is_single_precision
             ? ", as 32-bit floating-point numbers far from the origin are; export the scan in "
               "double precision, or subtract an offset before it is stored"
             : "; branches that are not several times as thick are rough guesses"));
}

/// Adds warnings about an implausible tree.
inline void warn_of_shape(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  // residual / noise: 0.67 for Gaussian noise, 0.5 to 0.9 for scans of trees, more than 2 for
  // spheres, cubes and dust [-]
  constexpr double max_residual = 1.5;
  // residual / spacing: residuals below this ratio are accepted for any noise [-]
  constexpr double exact = 0.1;
  // residual / trunk diameter: out-of-round sections and bark cause residuals up to this ratio [-]
  constexpr double oval = 0.02;
  // trunk diameter / trunk length: 0.01 to 0.1 for trees, more than 0.2 for spheres [-]
  constexpr double max_trunk_ratio = 0.2;
  constexpr double min_trunk_ratio = 0.002; // trunk diameter / height [-]
  // volume / cube of the largest root distance: up to 0.003 for trees, 0.008 for a post of ten
  // diameters, at least 0.03 for spheres interpreted as many thin branches [-]
  constexpr double max_wood = 0.015;
  // spacing / trunk diameter: above this ratio, volumes may be several times too large; real scans
  // have at most 0.2 [-]
  constexpr double max_spacing = 1.0 / 3;
  if (r.blade_fraction > 0)
    sentences.push_back(
        short_text(std::round(100 * r.blade_fraction)) +
        " % of the scanned area are sheets that are large compared with the plant, as "
        "leaf blades are: each has one axis, and diameters and volume are those of "
        "flat sections (skeleton_method(chains) fits cylinders to wood)");
  const auto& trunk = r.by_order.front();
  const double diameter = 2 * std::sqrt(trunk.volume / (pcs::internal::pi * trunk.length));
  if (r.status == Status::converged && r.method != Skeleton_method::level_sets && // no surfaces
      r.residual > std::max({max_residual * r.noise, exact * r.spacing, oval * diameter}))
    sentences.push_back("half of the points lie far from the surfaces found; this may be no tree "
                        "(skeleton_method(level_sets) is for plants with leaf blades)");
  if (diameter < min_trunk_ratio * r.height)
    sentences.push_back("the trunk is too thin for the height; the scan may show too little of it, "
                        "or wood was classified as leaves (do_remove_leaves(false) keeps it)");
  if (diameter > max_trunk_ratio * trunk.length)
    sentences.push_back("the trunk is shorter than five of its diameters; this may be no tree");
  else if (r.total.volume > max_wood * std::pow(r.max_root_distance, 3))
    sentences.push_back("there is more wood than a tree of this size has; this may be no tree");
  if (r.spacing > max_spacing * diameter)
    sentences.push_back("the points are farther apart than a third of the diameter of the trunk; "
                        "radii and volume are rough guesses");
}

/// Adds warnings about the foot, the trunk and the stems.
inline void warn_of_stems(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  constexpr double max_elevation = 0.1; // root elevation / height above the lowest points [-]
  if (r.hidden_trunk_length > 0)
    sentences.push_back("leaves hide the upper " + short_text(r.hidden_trunk_length) +
                        " of the trunk, which is inferred: it is continued straight to the "
                        "top of the tree (do_continue_trunk(false) keeps it as it was found)");
  if (r.root_elevation > max_elevation * (r.root_elevation + r.height))
    sentences.push_back("the root is " + short_text(r.root_elevation) +
                        (r.is_root_given
                             ? " above the lowest points: points below the given root_position "
                               "are not part of the result"
                             : " above the lowest points: the foot of the tree may be missing "
                               "from the result (root_position selects the foot)"));
  if (r.stem_diameters.size() > 1) {
    std::string list;
    for (const double d : r.stem_diameters)
      list += (list.empty() ? "" : ", ") + short_text(d);
    sentences.push_back("the tree forks below breast height into " +
                        std::to_string(r.stem_diameters.size()) + " stems with diameters of " +
                        list);
  }
}

/*!
  Returns the ratio of the standard error of the whole scan to the standard deviation among subsets
  with a fraction f of the points. It is sqrt(f / (1 - f)), as for the delete-d jackknife [Shao, Wu
  1989], but at least 1, since decisions by chance do not improve with more points.
*/
inline double jackknife_factor(double fraction)
{
  return fraction > 0 && fraction < 1 ? std::max(1.0, std::sqrt(fraction / (1 - fraction))) : 1;
}

/// Adds a warning about values that may differ between nearly identical scans by more than 1 % of
/// the height, 2 % of the diameter at breast height, 5 % of the length of the trunk, 5 % of the
/// volume, or 4 % of the breast height for the position of the root.
inline void warn_of_spread(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  // Two values differ by less than this number of standard deviations in 95 % of the cases:
  // Student's t for deviations among five values, times sqrt(2) [-]
  constexpr double factor = 3.93;
  constexpr double max_height = 0.01 / factor, max_diameter = 0.02 / factor;
  constexpr double max_trunk = 0.05 / factor, max_volume = 0.05 / factor;
  constexpr double max_root = 0.04 / factor; // of the breast height [-]
  const Skeleton_spread& s = r.spread;
  std::string list;
  const auto add = [&](const char* name, double deviation, double value, double limit) {
    if (deviation > limit * value)
      list += (list.empty() ? "" : ", ") + std::string(name) + " " + short_text(value) + " +- " +
              short_text(deviation);
  };
  if (s.number_of_empty_copies > 0)
    sentences.push_back(std::to_string(s.number_of_empty_copies) +
                        " resampled copies of this scan show no tree");
  if (s.is_leaf_removal_changed)
    sentences.push_back(
        "whether the scan has leaves is nearly undecided: " +
        std::to_string(s.number_of_leafy_copies) + " of " + std::to_string(s.number_of_copies) +
        " resampled copies have leaves; their majority contradicts the scan and was "
        "followed "
        "(do_remove_leaves(true) or do_remove_leaves(false) decides)");
  if (s.number_of_copies < 2)
    return;
  add("height", s.height, r.height, max_height);
  add("diameter at breast height",
      s.diameter_at_breast_height,
      r.diameter_at_breast_height,
      max_diameter);
  if (!r.by_order.empty())
    add("length of the trunk", s.trunk_length, r.by_order.front().length, max_trunk);
  add("volume", s.volume, r.total.volume, max_volume);
  if (s.root > max_root * r.breast_height)
    list +=
        (list.empty() ? "" : ", ") + std::string("position of the root +- ") + short_text(s.root);
  if (!list.empty())
    sentences.push_back("resampled copies of this scan give different values (one standard "
                        "deviation): " +
                        list);
}

} // namespace internal

/*!
  \ingroup PkgPcsSkeletonRef
  \brief standard errors of the values of a skeleton: differences from the true tree.

  For about 95 % of the trees, the true value lies within two standard errors.
*/
struct Skeleton_errors
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
  \brief returns the standard errors of a report with a spread.

  The error e of a value v with the standard deviation s among the resampled copies is
  \f$ e^2 = (k s)^2 + (b v)^2 \f$. The first term is the effect of chance, where k is the factor of
  the delete-d jackknife for the fraction of points in a copy. The second term holds errors that all
  copies share, such as occluded wood; b was calibrated on 139 virtual scans of all habits with 1 to
  6 stations and with or without leaves, see `benchmark/results/skeletons.md`. To the errors of
  volumes, half of the volume of a hidden trunk is added in the same way.

  \return errors of 0, and no size classes, if the report has fewer than two copies
*/
inline Skeleton_errors standard_errors(const Skeleton_report& r)
{
  constexpr double shared_by_size[] = {2.2, 0.44, 0.24, 0.22, 0.032}; // thinnest class first [-]
  Skeleton_errors result;
  const Skeleton_spread& s = r.spread;
  if (s.number_of_copies < 2 || r.by_order.empty())
    return result;
  const double factor = internal::jackknife_factor(s.fraction);
  const auto error = [&](double deviation, double value, double shared) {
    return std::hypot(factor * deviation, shared * value);
  };
  result.height = error(s.height, r.height, 0.0086);
  result.diameter_at_breast_height =
      error(s.diameter_at_breast_height, r.diameter_at_breast_height, 0.016);
  result.trunk_length = error(s.trunk_length, r.by_order.front().length, 0.021);
  result.length = error(s.length, r.total.length, 0.21);
  const double hidden = 0.5 * r.hidden_trunk_volume;
  result.volume = std::hypot(error(s.volume, r.total.volume, 0.076), hidden);
  result.trunk_volume = std::hypot(error(s.trunk_volume, r.by_order.front().volume, 0.022), hidden);
  for (std::size_t k = 0; k < std::min(s.volume_by_size.size(), r.by_size.size()); ++k)
    result.volume_by_size.push_back(error(s.volume_by_size[k],
                                          r.by_size[k].volume,
                                          shared_by_size[std::min<std::size_t>(k, 4)]));
  return result;
}

//! \ingroup PkgPcsSkeletonRef
//! returns one sentence for each reason to doubt the result; empty for most trees
inline std::vector<std::string> warnings(const Skeleton_report& r)
{
  std::vector<std::string> sentences;
  internal::warn_of_points(r, sentences);
  internal::warn_of_precision(r, sentences);
  internal::warn_of_unit("the tree", r.height, r.breast_height, sentences);
  if (!r.by_order.empty() && r.by_order.front().length > 0) {
    internal::warn_of_shape(r, sentences);
    internal::warn_of_stems(r, sentences);
    internal::warn_of_spread(r, sentences);
  }
  return sentences;
}

inline std::ostream& operator<<(std::ostream& out, const Skeleton_report& r)
{
  out << "status " << r.status << ", " << r.number_of_points << " points ("
      << r.number_of_duplicates << " duplicates, " << r.number_of_outliers << " outliers, "
      << r.number_of_leaf_points << " leaves, " << r.number_of_ground_points << " on the ground, "
      << r.number_of_wall_points << " on walls, " << r.number_of_unexplained_points
      << " unexplained, " << r.number_of_unexplained_thick_points << " of them on thick branches, "
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
