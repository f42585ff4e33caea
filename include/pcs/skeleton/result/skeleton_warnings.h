// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reasons to doubt a skeleton, as sentences.

#ifndef PCS_SKELETON_RESULT_SKELETON_WARNINGS_H
#define PCS_SKELETON_RESULT_SKELETON_WARNINGS_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/constants.h>
#include <pcs/internal/unit_of_height.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace pcs {
namespace internal {

/// Formats `value` with three significant digits, and with all digits before the decimal point.
inline std::string short_text(double value)
{
  std::ostringstream out;
  out.precision(3);
  if (std::abs(value) >= 999.5 && std::abs(value) < 1e9)
    out << static_cast<long long>(std::llround(value));
  else
    out << value;
  return out.str();
}

/// Returns whether coordinates are rounded to steps that merge or displace neighbouring points.
inline bool is_rounded(const Skeleton_report& r)
{
  constexpr double max_step = 0.5; // of the spacing [-]
  return r.coordinate_step > max_step * r.spacing;
}

/// Adds warnings about the precision of the coordinates.
inline void warn_of_precision(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  if (r.voxel_size > 0)
    sentences.push_back("the points are voxel centers of size " + short_text(r.voxel_size) +
                        "; branches that are not several times as thick are rough guesses");
  else if (is_rounded(r))
    sentences.push_back(
        "the coordinates are rounded to steps of " + short_text(r.coordinate_step) +
        (r.is_single_precision
             ? ", as 32-bit floating-point numbers far from the origin are; export the scan in "
               "double precision, or subtract an offset before it is stored"
             : "; branches that are not several times as thick are rough guesses"));
}

/// Adds warnings about the points of the scan.
inline void warn_of_points(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  constexpr double max_unreached = 0.05; // fraction of the points [-]
  constexpr double max_leaves = 0.5; // fraction of the points without ground, objects and walls [-]
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
  if (r.number_of_standing_branches > 0)
    sentences.push_back(std::to_string(r.number_of_standing_branches) +
                        " branches near the tree stand on the ground beside it: they were removed "
                        "as objects or other plants, and branches that touch them may be cut");
  if (r.number_of_wall_points > 0)
    sentences.push_back(std::to_string(r.number_of_wall_points) +
                        " points on or beside walls or other flat faces were removed; similar "
                        "objects may remain among the branches");
  const double tree = double(points) -
                      double(r.number_of_ground_points + r.number_of_object_points) -
                      double(r.number_of_wall_points);
  if (double(r.number_of_leaf_points) > max_leaves * tree)
    sentences.push_back("most of the points are classified as leaves, which hide wood: radii and "
                        "volume may differ much between scans of the same tree");
  if (r.rejected_station_shift > 0)
    sentences.push_back("the stations would have to move by up to " +
                        short_text(r.rejected_station_shift) +
                        ", too far for an error of registration, or have too few points, so no "
                        "points were moved; " +
                        (r.is_rejected_station_detected
                             ? "check the unit of breast_height, or use "
                               "do_register_stations(false)"
                             : "check that the labels denote scanner stations, not flight lines"));
  if (r.is_in_rows && !is_rounded(r)) // rounding also gives rows
    sentences.push_back("the points lie in sparse rows, in which leaves cannot be separated from "
                        "wood; all points are kept (do_remove_leaves(true) removes leaves)");
}

/// Returns the diameter of a cylinder with the length and volume of the trunk.
inline double trunk_diameter(const Skeleton_report& r)
{
  const Branch_totals& trunk = r.by_order.front();
  return 2 * std::sqrt(trunk.volume / (pcs::internal::pi * trunk.length));
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
  constexpr double min_lying = pcs::internal::pi / 3, max_lying = 2 * min_lying; // [rad]
  if (r.blade_fraction > 0)
    sentences.push_back(
        short_text(std::round(100 * r.blade_fraction)) +
        " % of the scanned area are sheets that are large compared with the plant, as "
        "leaf blades are: each has one axis, and diameters and volume are those of "
        "flat sections (skeleton_method(chains) fits cylinders to wood)");
  const double diameter = trunk_diameter(r);
  if (r.status == Status::converged && r.method != Skeleton_method::level_sets && // no surfaces
      r.residual > std::max({max_residual * r.noise, exact * r.spacing, oval * diameter}))
    sentences.push_back(std::string("half of the points lie far from the surfaces found; ") +
                        (r.is_skeleton_given
                             ? "check that the given skeleton is of this scan, in its coordinates "
                               "and unit"
                             : "this may be no tree (skeleton_method(level_sets) is for plants "
                               "with leaf blades)"));
  if (diameter < min_trunk_ratio * r.height)
    sentences.push_back(
        std::string("the trunk is too thin for the height; the scan may show too little of it") +
        (r.number_of_leaf_points > 0
             ? ", or wood was classified as leaves (do_remove_leaves(false) keeps it)"
             : ""));
  if (diameter > max_trunk_ratio * r.by_order.front().length)
    sentences.push_back("the trunk is shorter than five of its diameters; this may be no tree");
  else if (r.total.volume > max_wood * std::pow(r.max_root_distance, 3))
    sentences.push_back("there is more wood than a tree of this size has; this may be no tree");
  if (r.inclination > min_lying && !is_rounded(r)) // rounded wood has arbitrary directions
    sentences.push_back(
        std::string("the tree ") + (r.inclination < max_lying ? "lies" : "is upside down") +
        ": its wood points " + short_text(std::round(r.inclination * 180 / pcs::internal::pi)) +
        " degrees away from the up direction; check the vertical axis of the file "
        "(up_direction selects another)");
  if (r.spacing > max_spacing * diameter)
    sentences.push_back("the points are farther apart than a third of the diameter of the trunk; "
                        "radii and volume are rough guesses");
}

/// Adds warnings about the foot, the trunk and the stems.
inline void warn_of_stems(const Skeleton_report& r, std::vector<std::string>& sentences)
{
  constexpr double max_elevation = 0.1;  // root elevation / height above the lowest points [-]
  constexpr double much_inferred = 0.25; // of the volume [-]
  if (r.hidden_trunk_length > 0) {
    const double share = r.hidden_trunk_volume / r.total.volume;
    sentences.push_back(
        "leaves hide the upper " + short_text(r.hidden_trunk_length) +
        " of the trunk, which is inferred" +
        (share > much_inferred
             ? ", and with it " + short_text(std::round(100 * share)) + " % of the volume"
             : "") +
        ": it is continued straight to the top of the tree (do_continue_trunk(false) keeps it as "
        "it was found)");
  }
  // the axis of a lying stem is one radius above its underside
  if (r.root_elevation > std::max(max_elevation * (r.root_elevation + r.height), trunk_diameter(r)))
    sentences.push_back("the root is " + short_text(r.root_elevation) +
                        (r.is_root_given || r.is_skeleton_given
                             ? " above the lowest points: points below the given root "
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
  const Tree_values& v = r.estimates;
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
  add("height", s.height, v.height, max_height);
  add("diameter at breast height",
      s.diameter_at_breast_height,
      v.diameter_at_breast_height,
      max_diameter);
  add("length of the trunk", s.trunk_length, v.trunk_length, max_trunk);
  add("volume", s.volume, v.volume, max_volume);
  if (s.root > max_root * r.breast_height)
    list +=
        (list.empty() ? "" : ", ") + std::string("position of the root +- ") + short_text(s.root);
  if (!list.empty())
    sentences.push_back("resampled copies of this scan give different values (one standard "
                        "deviation): " +
                        list);
}

} // namespace internal

//! \ingroup PkgPcsSkeletonRef
//! returns one sentence for each reason to doubt the result; empty for most trees
inline std::vector<std::string> warnings(const Skeleton_report& r)
{
  std::vector<std::string> sentences;
  internal::warn_of_precision(r, sentences); // a cause of others
  internal::warn_of_points(r, sentences);
  internal::warn_of_unit("the tree",
                         std::max(r.height, r.max_root_distance), // it may lie
                         r.breast_height,
                         sentences);
  if (!r.by_order.empty() && r.by_order.front().length > 0) {
    internal::warn_of_shape(r, sentences);
    internal::warn_of_stems(r, sentences);
    internal::warn_of_spread(r, sentences);
  }
  return sentences;
}

} // namespace pcs

#endif // PCS_SKELETON_RESULT_SKELETON_WARNINGS_H
