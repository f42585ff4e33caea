// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The skeleton of a tree from a scan, stage by stage.

#ifndef PCS_TREE_SKELETONIZATION_H
#define PCS_TREE_SKELETONIZATION_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Skeleton_report.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/result_graph.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Resampled_session.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/input/check_input.h>
#include <pcs/skeleton/input/read_maps.h>
#include <pcs/skeleton/input/read_options.h>
#include <pcs/skeleton/resampling/resample_scan.h>
#include <pcs/skeleton/result/skeleton_warnings.h>
#include <pcs/skeleton/result/write_points.h>
#include <pcs/skeleton/result/write_result.h>

#include <CGAL/property_map.h>

#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsSkeletonRef
  \brief Extraction of a tree skeleton from a scan, one stage at a time.

  The class implements chapter 3 of \cite aiteanu2022 (\cite ak2014), except that all cross-sections
  of a branch are fitted together. Shortest paths from the root over the neighbour graph are cut
  into geodesic level sets, whose connected components form chains. Every chain becomes one branch
  axis, whose positions and radii are a robust least-squares fit to all of its points. Radii that
  the positions of the points do not determine are estimated from the number of points.

  Each stage first runs the preceding stages, unless they have run before. `extract()` runs all
  stages. The result of each stage can be inspected.

  \tparam PointRange a model of `RandomAccessRange`; positions are read by the constructor only,
          and the elements are keys of the property maps that `extract()` writes
  \tparam NamedParameters the type of the chain given to the constructor (deduced)
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`

  \par Memory
  The object needs about 350 bytes per point at the peak.

  \par Thread safety
  Different objects may be used concurrently, but each object only by one thread at a time.

  \par Determinism
  Results are bitwise identical for every number of threads and for the sequential tag.
*/
template <class PointRange,
          class NamedParameters = parameters::Default_named_parameters,
          class ConcurrencyTag = CGAL::Parallel_if_available_tag>
class Tree_skeletonization
{
  using Types = skeleton::internal::Skeleton_types<PointRange, NamedParameters>;

public:
  using Point_map = typename Types::Point_map;
  using Point = typename Types::Point;
  using Session = skeleton::Session<ConcurrencyTag>;

private:
  using Resampled_session = skeleton::Resampled_session<ConcurrencyTag>;
  static constexpr bool is_range_ok = is_random_access_range_v<const PointRange>;
  static_assert(
      is_range_ok,
      "pcs::Tree_skeletonization: the points must be a random access range, for example a "
      "std::vector");
  static constexpr bool is_point_ok = is_point_or_vector_v<Point>;
  static_assert(
      is_point_ok,
      "pcs::Tree_skeletonization: `point_map` must be a property map that stores points "
      "with x(), y(), z(), which are no integers, and a constructor from three coordinates, like "
      "Kernel::Point_3");
  static constexpr bool is_point_map_ok =
      !is_point_ok || is_readable_map_v<Point_map, typename Types::Element, Point>;
  static_assert(
      is_point_map_ok,
      "pcs::Tree_skeletonization: named parameter `point_map` must be readable and accept "
      "an element of `points` as key");
  static constexpr bool is_ok = is_range_ok && is_point_ok && is_point_map_ok;

public:
  /*!
    Reads the points and the named parameters, without running a stage. O(n) for n points.

    \param points at least `lowest_number_of_scan_points` distinct points [L]
    \param np named parameters, listed below
    \npbegin
      \np{point_map} where a position is read
        \nptype model of `ReadablePropertyMap`, key: element of `points`, value: a point type
        \npdefault `CGAL::Identity_property_map`
      \np{up_direction} the vertical, for the root, the ground and heights
        \nptype a vector with `x()`, `y()`, `z()`, not null
        \npdefault the z-axis
      \np{root_position} a position near the foot of the trunk [L]
        \nptype a point with `x()`, `y()`, `z()`
        \npdefault none: a stem near the lower end of the cloud is detected
      \np{do_register_stations} whether residual registration errors of a few millimetres are
          corrected: the points of each scanner station are moved until the branches of all stations
          coincide. Stations are given by `station_map`, or detected by their angular scan grids
        \nptype `bool`
        \npdefault `true`
      \np{station_map} the station that measured a point; negative: unknown. If there are fewer than
          two stations or more than 100, scan grids are detected instead
        \nptype model of `ReadablePropertyMap`, key: element of `points`, value: an integer type
        \npdefault none
      \np{scanner_positions} positions of the scanners [L]. They are used to correct the radii of
          thin branches for beam divergence
        \nptype range of points with `x()`, `y()`, `z()`
        \npdefault none
      \np{beam_width} beam divergence [rad]; 0: no correction. Used with `scanner_positions`
        \nptype floating point, `>= 0`
        \npdefault `default_beam_width`
      \np{given_skeleton} a skeleton whose node positions are kept; radii, cross-sections and the
          branch of each point are estimated from the scan
        \nptype model of `VertexListGraph` and `IncidenceGraph` of Boost, a tree with edges from
            parent to child (`std::cref()` avoids a copy)
        \npdefault none
      \np{given_point_map} the positions of its vertices
        \nptype model of `ReadablePropertyMap`, key: vertex descriptor, value: a point type
        \npdefault the bundled property of `Tree_skeleton`; needed for other graphs
      \np{skeleton_method} how branches are found
        \nptype `Skeleton_method`: `automatic`; `chains`; `sections`, the published method
            \cite aiteanu2022; or `level_sets`, for plants with leaf blades
        \npdefault `automatic`
      \np{slice_options} options of the method `sections`: how slices are cut, fitted and tilted,
          how sections are connected, and the radii of sparse branches
        \nptype `Slice_options`
        \npdefault the published options
      \np{do_remove_ground} whether ground around the foot, separate objects that stand on it, and
          flat faces such as walls and roofs are removed
        \nptype `bool`
        \npdefault `true`
      \np{breast_height} height above the root at which the diameter in the report is measured. The
          limits of the size classes are proportional to it [L]
        \nptype floating point, `> 0`
        \npdefault `default_breast_height`, for scans in metres
      \np{number_of_resamples} number of random subsets of the scan whose skeletons give the
          standard deviations in `Skeleton_report::spread` [count]. A subset has 90 % of the points,
          but at most 40,000, and takes as long as a scan of its size; several are processed at a
          time. If the subsets have at least half of the points, the medians of all skeletons are
          `Skeleton_report::estimates`, the majority of the scan and the subsets decides whether
          there are leaves, and a skeleton that differs from most subsets is replaced by that of
          points displaced by a thousandth of their spacing. Where the medians are uncertain, there
          are up to four times as many subsets, with at most 200,000 points together, and at most as
          many displaced scans. Scans with fewer than 100 points have no subsets
        \nptype integer, 0 to 100
        \npdefault 0: the spread is not estimated
      \np{wood_map} whether a point may belong to a branch; others (leaves) are not used
        \nptype model of `ReadablePropertyMap`, key: element of `points`, value: `bool`
        \npdefault all points
      \np{do_remove_leaves} whether leaf points are removed: always (`true`), never (`false`), or
          where leaves are detected. Used by the method `chains` only
        \nptype `bool` or `Leaf_removal`
        \npdefault `Leaf_removal::where_found`; `Leaf_removal::never` if `wood_map` is given
      \np{do_continue_trunk} whether a trunk that leaves hide is continued straight to the top of
          the tree, with inferred radii: `is_measured` of its nodes is `false`, and
          `Skeleton_report::hidden_trunk_length` is its length. Used by the method `chains` only,
          if leaves were removed, but not with `wood_map` or `given_skeleton`
        \nptype `bool`
        \npdefault `true`
      \np{point_branch_map} written by `extract()`: index of the branch of a point in the result, or
          `npos`
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: an integer type
        \npdefault none
      \np{point_residual_map} written by `extract()`: signed distance from the surface of the
          branch, negative inside, 0 for points without a branch [L]. Points of registered stations
          are at their registered positions
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: floating point
        \npdefault none
      \np{point_is_dense_map} written by `extract()`: whether the cross-section of the branch at the
          point was fitted to points
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: `bool`
        \npdefault none
      \np{point_is_leaf_map} written by `extract()`: whether the point was removed as a leaf, by
          `wood_map` or `do_remove_leaves`
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: `bool`
        \npdefault none
      \np{normal_map} written by `extract()`: outward unit normal of the branch at the point, the
          null vector for points without a branch. If `Slice_options::has_normals` is set, the
          method `sections` first reads the normals of the input from it, where null vectors are
          unknown normals
        \nptype model of `WritablePropertyMap`, key: element of `points`, value: a vector type
        \npdefault none
      \np{node_point_map} where the position of a vertex of the result is written
        \nptype model of `WritablePropertyMap`, key: vertex descriptor, value: a point type
        \npdefault the bundled property of `Tree_skeleton`; needed for other graphs
      \np{node_radius_map} where the radius of a vertex of the result is written [L]
        \nptype model of `WritablePropertyMap`, key: vertex descriptor, value: floating point
        \npdefault the bundled property of `Tree_skeleton`; needed for other graphs
      \np{node_radius_error_map} where the standard error of this radius is written [L]; for graphs
          other than `Tree_skeleton`
        \nptype model of `WritablePropertyMap`, key: vertex descriptor, value: floating point
        \npdefault none
      \np{node_branch_map} where the index of the branch of a vertex is written; 0 is the trunk. For
          graphs other than `Tree_skeleton`
        \nptype model of `WritablePropertyMap`, key: vertex descriptor, value: an integer type
        \npdefault none
      \np{callback} called on this thread with a value that grows from 0 to 1; `false` stops
        \nptype `std::function<bool(double)>`
        \npdefault none
    \npend

    \throws Invalid_input if there are too few points, a coordinate is not finite or beyond 1e50, a
            parameter is out of range, or the root or the given skeleton is farther from the
            bounding box of the points than the length of the diagonal of this box
  */
  explicit Tree_skeletonization(const PointRange& points,
                                const NamedParameters& np = NamedParameters())
    : m_points(&points), m_np(np)
  {
    if constexpr (is_ok) {
      skeleton::Input_options options = skeleton::read_skeleton_options(m_np, function);
      m_callback = std::move(options.callback);
      const auto point_map =
          internal::choose(m_np,
                           CGAL::internal_np::point_map,
                           CGAL::Identity_property_map<std::decay_t<typename Types::Element>>());
      skeleton::Scan_points scan;
      scan.positions = skeleton::internal::read_input(points, point_map, function);
      skeleton::check_input(scan.positions, options.hints, function);
      scan.is_wood = skeleton::internal::read_wood(points, m_np, function);
      scan.stations = skeleton::internal::read_stations(points, m_np);
      scan.normals = skeleton::internal::read_normals(points, m_np, options.hints.slices, function);
      m_resampled = std::make_unique<Resampled_session>(std::move(scan),
                                                        std::move(options.hints),
                                                        options.number_of_resamples);
    }
  }

  Tree_skeletonization(Tree_skeletonization&&) = default;
  Tree_skeletonization& operator=(Tree_skeletonization&&) = default;

  /// \name Stages
  /// Each stage returns `false` if the callback stopped it; it may then be called again.
  /// @{

  //! finds neighbours, spacing, duplicates and outliers. O(n log n)
  bool find_neighbors() { return run(&Session::find_neighbors); }
  //! finds ground, root, shortest paths and the tree of level-set components. O(n log n)
  bool find_paths() { return run(&Session::find_paths); }
  //! fits the axes and radii of all branches. O(n log n)
  bool fit_axes() { return run(&Session::fit_axes); }
  //! joins the axes to one rooted tree and fits cross-sections. O(axes log axes)
  bool join() { return run(&Session::join); }

  /*!
    Runs the stages that have not run, and writes the result.

    \tparam Graph `Tree_skeleton<Kernel>`, or any model of `MutableGraph` of Boost with
            `node_point_map` and `node_radius_map` given. It becomes a tree with edges from parent
            to child; the first vertex is the root
    \param tree replaced by the result; unchanged if no tree was found or the callback stopped the
           work; empty if memory runs out while it is written
  */
  template <class Graph>
  Skeleton_report extract(Graph& tree)
  {
    constexpr bool is_ready_made = internal::Is_tree_skeleton<Graph>::value;
    constexpr bool has_maps =
        internal::is_given_v<NamedParameters, internal_np::node_point_map_t> &&
        internal::is_given_v<NamedParameters, internal_np::node_radius_map_t>;
    constexpr bool is_graph_ok = skeleton::internal::Is_mutable_graph<Graph>::value;
    static_assert(is_graph_ok,
                  "pcs::extract_tree_skeleton(): the result must be a mutable graph of Boost, for "
                  "example pcs::Tree_skeleton<Kernel>");
    static_assert(!is_graph_ok || is_ready_made || has_maps,
                  "pcs::extract_tree_skeleton(): a graph that is no pcs::Tree_skeleton needs the "
                  "named parameters `node_point_map` and `node_radius_map`");
    if constexpr (is_graph_ok && is_ok && (is_ready_made || has_maps)) {
      if (!m_resampled->complete(m_callback)) {
        Skeleton_report report;
        report.status = Status::cancelled;
        report.number_of_points = session().report().number_of_points;
        return report;
      }
      Skeleton_report report = m_resampled->report(); // before `tree` changes
      if (m_callback)
        m_callback(1); // it may throw
      if (session().report().status == Status::converged)
        internal::write_or_clear(tree, [&] {
          if constexpr (is_ready_made)
            skeleton::write_ready_made(session().tree(), session().scan().frame, tree);
          else
            skeleton::write_graph(session().tree(), session().scan().frame, m_np, tree);
        });
      skeleton::write_points(session(), *m_points, m_np);
      return report;
    } else
      return Skeleton_report();
  }

  /// @}

  /// \name Results of the Stages
  /// Coordinates and lengths are those of `scan().frame`, except for the report, which is in the
  /// unit of the input.
  /// @{
  const skeleton::Scan& scan() const { return session().scan(); }
  const skeleton::Layer_tree& layers() const { return session().layers(); }
  const skeleton::Axis_set& axes() const { return session().axes(); }
  const std::vector<skeleton::Joint>& joints() const { return session().joints(); }
  const skeleton::Branch_tree& branches() const { return session().tree(); }
  const Skeleton_report& report() const { return session().report(); }
  /// @}

private:
  static constexpr const char* function = "pcs::extract_tree_skeleton()";

  bool run(bool (Session::*stage)(internal::Progress&))
  {
    internal::Progress progress(m_resampled->callback_of_stages(m_callback));
    return (m_resampled->session().*stage)(progress);
  }

  const Session& session() const { return m_resampled->session(); }

  const PointRange* m_points;
  NamedParameters m_np;
  std::function<bool(double)> m_callback;
  std::unique_ptr<Resampled_session> m_resampled;
};

} // namespace pcs

#endif // PCS_TREE_SKELETONIZATION_H
