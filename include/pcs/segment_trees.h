// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Segmentation of the scan of a stand into individual trees.

#ifndef PCS_SEGMENT_TREES_H
#define PCS_SEGMENT_TREES_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Status.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/internal/unit_of_height.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/forest/Stand.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/input/check_input.h>
#include <pcs/skeleton/input/read_options.h>

#include <CGAL/property_map.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! a tree found by `segment_trees()`
struct Segmented_tree
{
  //! base of the axis of its thickest stem, in coordinates of the input; it is moved to the ground
  //! below if that is known, and at most breast height away [L]
  std::array<double, 3> foot{};
  double radius = 0; ///< largest radius of that stem up to half the breast height [L]
  double diameter_at_breast_height = 0; ///< of that stem; 0 if it ends below [L]
  std::size_t number_of_points = 0;     ///< [count]
  double height = 0;                    ///< of its highest point above the foot [L]
  //! height of the lower end of this axis above the ground; 0 if the ground is not known [L]
  double foot_above_ground = 0;
  //! standard deviations of its points along their principal axes, in ascending order [L]
  std::array<double, 3> deviations{};
};

//! \ingroup PkgPcsSkeletonRef
//! statistics of `segment_trees()`
struct Segmentation_report
{
  //! `converged`; `nothing_to_do` if there is no stem; `cancelled`
  Status status = Status::nothing_to_do;
  std::size_t number_of_points = 0; ///< of the input [count]
  //! ground, walls, outliers, and points that are not connected to a tree [count]
  std::size_t number_of_unassigned_points = 0;
  std::vector<Segmented_tree> trees; ///< by decreasing radius
  //! plants lower than breast height, such as shrubs; they are not among the trees, unless no tree
  //! is higher [count]
  std::size_t number_of_low_plants = 0;
  double breast_height = 0; ///< as given [L]
  double seconds = 0;       ///< wall-clock time [s]
};

namespace internal {

/// A reason to doubt trees, and the indices of these trees.
struct Tree_doubt
{
  std::string what;
  std::vector<std::size_t> trees;
};

/// Returns the reasons to doubt trees, with at least one tree each.
inline std::vector<Tree_doubt> doubts_of_trees(const Segmentation_report& r)
{
  constexpr double max_diameter = 0.1;   // stem diameter / height; trees: 0.01 to 0.05 [-]
  constexpr double min_diameter = 0.003; // at breast height / height; slender trees: 0.007 [-]
  constexpr double max_foot = 0.1; // height of the lower end of the stem / height of the tree [-]
  // deviations across a bare stem: 0.35 diameters; across a plane, relative to those within: 0.01
  // to 0.05; trees with crowns: more than one diameter, and 0.3 [-]
  constexpr double bare = 0.5, flat = 0.1;
  // a tree without its top: height and radius, in medians of a stand of at least this many trees
  constexpr double cut_height = 0.6, full_radius = 0.8;
  constexpr std::size_t min_trees = 4;
  // a stem hidden by shrubs: diameter at breast height / height, in medians of the stand, and at
  // least, since old trees are stouter than young ones [-]
  constexpr double stout = 2, min_stout = 0.04;
  std::vector<Tree_doubt> doubts;
  const auto add = [&](const std::string& what, const auto& is_doubtful) {
    Tree_doubt doubt{what, {}};
    for (std::size_t t = 0; t < r.trees.size(); ++t)
      if (is_doubtful(r.trees[t]))
        doubt.trees.push_back(t);
    if (!doubt.trees.empty())
      doubts.push_back(doubt);
  };
  const auto is_low = [&](const Segmented_tree& t) { return t.height < r.breast_height; };
  add("lower than breast height, perhaps shrubs", is_low);
  add("with a stem too thick for the height, perhaps several stems or ground in one",
      [&](const Segmented_tree& t) {
        return !is_low(t) &&
               std::max(2 * t.radius, t.diameter_at_breast_height) > max_diameter * t.height;
      });
  add("with a diameter at breast height too small for the height; the scan may show too little of "
      "the stem there",
      [&](const Segmented_tree& t) {
        return t.diameter_at_breast_height > 0 &&
               t.diameter_at_breast_height < min_diameter * t.height;
      });
  add("with a stem that begins far above the ground; its lower part may be missing or too sparse, "
      "so foot, diameter and height may be wrong",
      [&](const Segmented_tree& t) { return t.foot_above_ground > max_foot * t.height; });
  const auto is_bare = [&](const Segmented_tree& t) {
    return !is_low(t) && t.deviations[1] > 0 &&
           t.deviations[1] < bare * std::max(2 * t.radius, t.diameter_at_breast_height);
  };
  add("without a crown, perhaps posts or bare stems", is_bare);
  add("with all points in a plane, perhaps walls or fences", [&](const Segmented_tree& t) {
    return !is_low(t) && !is_bare(t) && t.deviations[1] > 0 &&
           t.deviations[0] < flat * t.deviations[1];
  });
  if (r.trees.size() < min_trees)
    return doubts;
  std::vector<double> heights, radii, ratios;
  for (const Segmented_tree& tree : r.trees) {
    heights.push_back(tree.height);
    radii.push_back(tree.radius);
    if (tree.diameter_at_breast_height > 0 && !is_low(tree))
      ratios.push_back(tree.diameter_at_breast_height / tree.height);
  }
  const double limit = std::max(min_stout, stout * internal::lower_median(ratios));
  add("thicker at breast height than others of the same height; shrubs or other stems may hide "
      "the stem",
      [&](const Segmented_tree& t) {
        return !is_low(t) && t.diameter_at_breast_height > limit * t.height &&
               t.diameter_at_breast_height <= max_diameter * t.height;
      });
  const double typical_height = internal::lower_median(heights),
               typical_radius = internal::lower_median(radii);
  add("much lower than others with stems as thick; the top may be missing, or part of a "
      "neighbouring tree",
      [&](const Segmented_tree& t) {
        return !is_low(t) && t.height < cut_height * typical_height &&
               t.radius > full_radius * typical_radius;
      });
  return doubts;
}

} // namespace internal

//! \ingroup PkgPcsSkeletonRef
//! returns one sentence for each reason to doubt the segmentation; empty for most stands
inline std::vector<std::string> warnings(const Segmentation_report& r)
{
  constexpr std::size_t max_listed = 8;
  double height = 0;
  for (const Segmented_tree& tree : r.trees)
    height = std::max(height, tree.height);
  std::vector<std::string> sentences;
  internal::warn_of_unit("a tree", height, r.breast_height, sentences);
  for (const internal::Tree_doubt& doubt : internal::doubts_of_trees(r)) {
    std::string list;
    for (std::size_t k = 0; k < std::min(max_listed, doubt.trees.size()); ++k)
      list += (k == 0 ? "" : ", ") + std::to_string(doubt.trees[k]);
    sentences.push_back(std::to_string(doubt.trees.size()) + " tree(s) " + doubt.what +
                        ": number " + list + (doubt.trees.size() > max_listed ? ", ..." : ""));
  }
  return sentences;
}

//! \ingroup PkgPcsSkeletonRef
//! returns the reasons of `warnings()` for each tree, in the order of the trees; empty for most
inline std::vector<std::vector<std::string>> warnings_of_trees(const Segmentation_report& r)
{
  std::vector<std::vector<std::string>> reasons(r.trees.size());
  for (const internal::Tree_doubt& doubt : internal::doubts_of_trees(r))
    for (const std::size_t tree : doubt.trees)
      reasons[tree].push_back(doubt.what);
  return reasons;
}

namespace internal {

/// Writes the tree of each point, and the number of points and the height of each tree.
template <class PointRange, class PointMap, class PointTreeMap>
void write_trees(const skeleton::Stand& stand,
                 const skeleton::Vec3& up,
                 PointRange& points,
                 const PointMap& point_map,
                 PointTreeMap point_tree_map,
                 Segmentation_report& report)
{
  for (const skeleton::Detected_tree& tree : stand.trees) {
    report.trees.push_back(
        {{tree.foot.x(), tree.foot.y(), tree.foot.z()}, tree.radius, 2 * tree.radius_at_breast});
    report.trees.back().foot_above_ground = tree.above_ground;
  }
  report.number_of_low_plants = stand.number_of_low_plants;
  std::vector<Eigen::Vector3d> sums(report.trees.size(), Eigen::Vector3d::Zero());
  std::vector<Eigen::Matrix3d> squares(report.trees.size(), Eigen::Matrix3d::Zero());
  std::size_t i = 0;
  for (auto it = std::begin(points); it != std::end(points); ++it, ++i) {
    const skeleton::Index tree = stand.tree_of_input[i];
    if (tree == skeleton::none)
      ++report.number_of_unassigned_points;
    else {
      Segmented_tree& found = report.trees[tree];
      ++found.number_of_points;
      const skeleton::Vec3 p = skeleton::internal::to_vec3(get(point_map, *it));
      const skeleton::Vec3 d = p - stand.trees[tree].foot;
      found.height = std::max(found.height, up.dot(d));
      sums[tree] += d;
      squares[tree] += d * d.transpose();
    }
    put(point_tree_map,
        *it,
        static_cast<pcs::Map_value<PointTreeMap>>(tree == skeleton::none ? npos
                                                                         : std::size_t(tree)));
  }
  for (std::size_t t = 0; t < report.trees.size(); ++t) {
    const double n = double(std::max<std::size_t>(report.trees[t].number_of_points, 1));
    const Eigen::Matrix3d covariance = squares[t] / n - (sums[t] / n) * (sums[t] / n).transpose();
    const Eigen::Vector3d values = linear_algebra::symmetric_eigen<3>(covariance).values;
    for (Eigen::Index k = 0; k < 3; ++k)
      report.trees[t].deviations[std::size_t(k)] = std::sqrt(std::max(0.0, values(k)));
  }
}

} // namespace internal

/*!
  \ingroup PkgPcsSkeletonRef
  \brief segments the scan of a stand into individual trees.

  A stem is an axis that begins near the ground, hardly tapers there, and rises steeply by at least
  half the breast height. Two stems belong to the same tree if the horizontal distance of their feet
  is less than the sum of three radii of the thicker stem, a tenth of the breast height, and the
  height of the higher foot above the ground. Where crowns touch, an axis is assigned to the tree
  that it most likely continues. The likelihood depends on distance, direction and radius, as where
  `extract_tree_skeleton()` joins axes. A point without an axis is assigned to the tree whose foot
  has the smallest geodesic distance. Ground, walls and outliers remain unassigned, except for
  ground points at the foot of a stem. Plants lower than breast height are counted, but they are
  trees only if no tree is higher.

  The scan is thinned to one point per voxel, with a voxel size of a 65th of the breast height. All
  points of a voxel are assigned to the tree of the point that represents it. Sparsely sampled trees
  are segmented again with voxels three times as large.

  The points of one tree can be passed to `extract_tree_skeleton()`.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \param points a model of `RandomAccessRange` with at least `lowest_number_of_scan_points`
         distinct points [L]
  \param point_tree_map a model of `WritablePropertyMap`, key: element of `points`, value: a type
         to which `std::size_t` converts. Receives the index of the tree in the report, or `npos`;
         unchanged if the callback stopped the work
  \param np named parameters, listed below
  \npbegin
    \np{point_map} where a position is read
      \nptype model of `ReadablePropertyMap`, key: element of `points`, value: a point type
      \npdefault `CGAL::Identity_property_map`
    \np{up_direction} the direction in which trees grow
      \nptype a vector with `x()`, `y()`, `z()`, not null
      \npdefault the z-axis
    \np{breast_height} breast height, to which all size limits are relative [L]
      \nptype floating point, `> 0`
      \npdefault `default_breast_height`, for scans in metres
    \np{do_remove_ground} whether ground and flat faces are removed
      \nptype `bool`
      \npdefault `true`
    \np{callback} called on this thread with a value that grows from 0 to 1; `false` stops
      \nptype `std::function<bool(double)>`
      \npdefault none
  \npend
  \return a `Segmentation_report`

  \throws Invalid_input if there are too few points, a coordinate is not finite or beyond 1e50, or
      a parameter is out of range
  \par Complexity
  The time is \f$O(n \log n)\f$. Besides `points`, the memory is at most about 240 bytes per point
  that remains after thinning, and 8 bytes per other point, but at least 60 bytes per point. Noisy
  scans with many short axes need up to 260 bytes. Positions are read three times through
  `point_map`, since they are not stored.
  \par Determinism
  Results are identical for every number of threads and for the sequential tag.
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class PointRange,
          class PointTreeMap,
          class NamedParameters = parameters::Default_named_parameters>
Segmentation_report segment_trees(PointRange& points,
                                  PointTreeMap point_tree_map,
                                  const NamedParameters& np = NamedParameters())
{
  using Types = skeleton::internal::Skeleton_types<PointRange, NamedParameters>;
  using Element = Element_reference<PointRange>; // an element may store the index of its tree
  constexpr bool is_range_ok = is_random_access_range_v<const PointRange>;
  static_assert(is_range_ok,
                "pcs::segment_trees(): the points must be a random access range, for example a "
                "std::vector");
  constexpr bool is_point_ok = is_point_or_vector_v<typename Types::Point>;
  static_assert(is_point_ok,
                "pcs::segment_trees(): `point_map` must be a property map that stores points with "
                "x(), y(), z(), which are no integers, and a constructor from three coordinates, "
                "like Kernel::Point_3");
  constexpr bool is_point_map_ok =
      !is_point_ok ||
      is_readable_map_v<typename Types::Point_map, typename Types::Element, typename Types::Point>;
  static_assert(is_point_map_ok,
                "pcs::segment_trees(): named parameter `point_map` must be readable and accept an "
                "element of `points` as key");
  constexpr bool is_tree_map_ok = is_map_for_v<PointTreeMap, Element, std::size_t>;
  static_assert(is_tree_map_ok,
                "pcs::segment_trees(): `point_tree_map` must be writable, accept an element of "
                "`points` as key, and store what a std::size_t converts to");
  Segmentation_report report;
  if constexpr (is_range_ok && is_point_ok && is_point_map_ok && is_tree_map_ok) {
    const std::string caller = "pcs::segment_trees()";
    const skeleton::Input_options options = skeleton::read_segmentation_options(np, caller);
    const skeleton::Session_hints& hints = options.hints;
    internal::Stopwatch watch;
    const auto point_map = internal::choose(np,
                                            CGAL::internal_np::point_map,
                                            CGAL::Identity_property_map<std::decay_t<Element>>());
    const auto read = [&] {
      std::vector<skeleton::Vec3> input = skeleton::internal::read_input(points, point_map, caller);
      skeleton::check_input(input, hints, caller);
      return input;
    };
    internal::Progress progress(options.callback);
    report.number_of_points = static_cast<std::size_t>(std::end(points) - std::begin(points));
    report.breast_height = hints.breast_height;
    skeleton::Stand forest;
    if (!skeleton::find_trees<ConcurrencyTag>(read, hints, progress, forest)) {
      report.status = Status::cancelled;
      return report;
    }
    internal::write_trees(forest, hints.up, points, point_map, point_tree_map, report);
    report.status = report.trees.empty() ? Status::nothing_to_do : Status::converged;
    report.seconds = watch.lap();
  }
  return report;
}

} // namespace pcs

#endif // PCS_SEGMENT_TREES_H
