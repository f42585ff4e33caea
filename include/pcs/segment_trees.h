// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The single trees in the scan of a stand.

#ifndef PCS_SEGMENT_TREES_H
#define PCS_SEGMENT_TREES_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Status.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/internal/unit_of_height.h>
#include <pcs/skeleton/forest/Stand.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/input/check_input.h>
#include <pcs/skeleton/input/read_options.h>

#include <CGAL/property_map.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsSkeletonRef
//! one of the trees that `segment_trees()` found
struct Segmented_tree
{
  std::array<double, 3>
      foot{}; ///< where the axis of its thickest stem begins, in the coordinates of the input
  double radius = 0; ///< of that stem, the largest up to half the breast height above the foot [L]
  std::size_t number_of_points = 0; ///< [count]
  double height = 0;                ///< of its highest point above the foot [L]
};

//! \ingroup PkgPcsSkeletonRef
//! what `segment_trees()` found
struct Segmentation_report
{
  //! `converged`; `nothing_to_do` if there is no stem; `cancelled`
  Status status = Status::nothing_to_do;
  std::size_t number_of_points = 0; ///< of the input [count]
  std::size_t number_of_unassigned_points =
      0;                             ///< ground, walls, outliers, and what no tree reaches [count]
  std::vector<Segmented_tree> trees; ///< the thick ones first
  double breast_height = 0;          ///< as it was given [L]
  double seconds = 0;                ///< wall time [s]
};

//! \ingroup PkgPcsSkeletonRef
//! what makes a segmentation doubtful, a sentence each; empty for most
inline std::vector<std::string> warnings(const Segmentation_report& r)
{
  double height = 0;
  for (const Segmented_tree& tree : r.trees)
    height = std::max(height, tree.height);
  std::vector<std::string> sentences;
  internal::warn_of_unit("a tree", height, r.breast_height, sentences);
  return sentences;
}

/*!
  \ingroup PkgPcsSkeletonRef
  \brief finds the trees in the scan of a stand, and tells for every point whose it is.

  A stem is an axis that begins near the ground, is not much thinner there, and rises steeply by
  half the breast height at least. Stems whose feet are nearer than three radii, a tenth of the
  breast height and as much as one of them is above the ground are one tree. Where crowns touch, the
  points of an axis belong to the tree whose branch it most likely prolongs, by the same odds of
  distance, direction and radius that `extract_tree_skeleton()` joins axes by; points without an
  axis to the tree whose foot is nearest along the points. Ground, walls and outliers are left out
  as there, but for the ground's part of the stems. One point is looked at in every cube of a 65th
  of the breast height, and decides for the others. Trees of which the points are farther apart than
  those of others are looked for once more in cubes three times as large; they get what they have
  there of such points, and of those that are nobody's.

  The points of one tree are a scan for `extract_tree_skeleton()`.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \param points a model of `RandomAccessRange`; at least `lowest_number_of_scan_points` different
         ones, whose elements may take their trees
  \param point_tree_map a model of `WritablePropertyMap`, key: element of `points`, value: a type
         that `std::size_t` converts to. Takes the index of the tree in the report, or `npos`;
         untouched if the callback stopped the work
  \param np
  \npbegin
    \np{point_map} where a position is read
      \nptype model of `ReadablePropertyMap`, key: element of `points`, value: a point type
      \npdefault `CGAL::Identity_property_map`
    \np{up_direction} where trees grow to
      \nptype a vector with `x()`, `y()`, `z()`, not null
      \npdefault the z-axis
    \np{breast_height} unit of all sizes that a stem must have [L]
      \nptype floating point, `> 0`
      \npdefault `default_breast_height`, for scans in metres
    \np{do_remove_ground} whether ground and flat faces are looked for and left out
      \nptype `bool`
      \npdefault `true`
    \np{callback} called on this thread with a value that grows from 0 to 1; `false` stops
      \nptype `std::function<bool(double)>`
      \npdefault none
  \npend
  \return a `Segmentation_report`

  \throws Invalid_input if there are too few points, a coordinate is not finite or beyond 1e100, or
      a parameter is out of range
  \par Complexity
  \f$O(n \log n)\f$ in time, 350 bytes per point that is looked at, and some 70 bytes per other
      point.
  \par Determinism
  Same result for every number of threads and for the sequential tag.
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
  using Element = Element_reference<PointRange>; // which may hold its tree itself
  constexpr bool is_range_ok = is_random_access_range_v<const PointRange>;
  static_assert(is_range_ok,
                "pcs::segment_trees(): the points must be a random access range, for example a "
                "std::vector");
  constexpr bool is_point_ok = is_point_or_vector_v<typename Types::Point>;
  static_assert(is_point_ok,
                "pcs::segment_trees(): `point_map` must be a property map that stores points with "
                "x(), y(), z() and a constructor from three coordinates, like Kernel::Point_3");
  constexpr bool is_tree_map_ok = is_map_for_v<PointTreeMap, Element, std::size_t>;
  static_assert(is_tree_map_ok,
                "pcs::segment_trees(): `point_tree_map` must be writable, accept an element of "
                "`points` as key, and store what a std::size_t converts to");
  Segmentation_report report;
  if constexpr (is_range_ok && is_point_ok && is_tree_map_ok) {
    const std::string function = "pcs::segment_trees()";
    internal::Stopwatch watch;
    skeleton::Session_hints hints;
    hints.up = skeleton::read_up_direction(np, function);
    hints.breast_height = skeleton::read_breast_height(np, function);
    hints.do_mark_ground = internal::choose(np, internal_np::do_remove_ground, true);
    const auto point_map = internal::choose(np,
                                            CGAL::internal_np::point_map,
                                            CGAL::Identity_property_map<std::decay_t<Element>>());
    const std::vector<skeleton::Vec3> input =
        skeleton::internal::read_input(points, point_map, function);
    skeleton::check_input(input, hints, function);
    internal::Progress progress(
        internal::choose(np, CGAL::internal_np::callback, std::function<bool(double)>()));
    report.number_of_points = input.size();
    report.breast_height = hints.breast_height;
    skeleton::Stand forest;
    if (!skeleton::find_trees<ConcurrencyTag>(input, hints, progress, forest)) {
      report.status = Status::cancelled;
      return report;
    }
    for (const skeleton::Detected_tree& tree : forest.trees)
      report.trees.push_back({{tree.foot.x(), tree.foot.y(), tree.foot.z()}, tree.radius});
    std::size_t i = 0;
    for (auto it = std::begin(points); it != std::end(points); ++it, ++i) {
      const skeleton::Index tree = forest.tree_of_input[i];
      if (tree == skeleton::none)
        ++report.number_of_unassigned_points;
      else {
        Segmented_tree& found = report.trees[tree];
        ++found.number_of_points;
        found.height = std::max(found.height, hints.up.dot(input[i] - forest.trees[tree].foot));
      }
      put(point_tree_map,
          *it,
          static_cast<Map_value<PointTreeMap>>(tree == skeleton::none ? npos : std::size_t(tree)));
    }
    report.status = report.trees.empty() ? Status::nothing_to_do : Status::converged;
    report.seconds = watch.lap();
  }
  return report;
}

} // namespace pcs

#endif // PCS_SEGMENT_TREES_H
