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
#include <pcs/core/parameters/check_value.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session.h>
#include <pcs/skeleton/estimate_spread.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/input/check_input.h>
#include <pcs/skeleton/input/read_options.h>
#include <pcs/skeleton/result/write_result.h>

#include <CGAL/property_map.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
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
        \nptype `Skeleton_method`: `chains`; `sections`, the published method \cite aiteanu2022; or
            `level_sets`, for plants with leaf blades
        \npdefault `chains`
      \np{slice_options} options of the method `sections`: how slices are cut, fitted and tilted,
          how sections are connected, and the radii of sparse branches
        \nptype `Slice_options`
        \npdefault the published options
      \np{do_remove_ground} whether ground around the foot and flat faces such as walls and roofs
          are removed
        \nptype `bool`
        \npdefault `true`
      \np{breast_height} height above the root at which the diameter in the report is measured. The
          limits of the size classes are proportional to it [L]
        \nptype floating point, `> 0`
        \npdefault `default_breast_height`, for scans in metres
      \np{number_of_resamples} number of random subsets of the scan whose skeletons give the
          standard deviations in `Skeleton_report::spread` [count]. A subset has 90 % of the points,
          but at most 40,000, and takes as long as a scan of its size. If the subsets have at least
          half of the points, the majority of the scan and the subsets decides whether there are
          leaves, and a skeleton that differs from most subsets is replaced by that of points
          displaced by a thousandth of their spacing
        \nptype integer, 0 to 100
        \npdefault 0: the spread is not estimated
      \np{wood_map} whether a point may belong to a branch; others (leaves) are not used
        \nptype model of `ReadablePropertyMap`, key: element of `points`, value: `bool`
        \npdefault all points
      \np{do_remove_leaves} whether leaf points are removed: always (`true`), never (`false`), or
          where leaves are detected. Used by the method `chains` only
        \nptype `bool` or `Leaf_removal`
        \npdefault `Leaf_removal::where_found`; `Leaf_removal::never` if `wood_map` is given
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

    \throws Invalid_input if there are too few points, a coordinate is not finite or beyond 1e100, a
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
      std::vector<skeleton::Vec3> input = read_points();
      skeleton::check_input(input, options.hints, function);
      std::vector<std::uint8_t> is_wood = read_wood();
      options.hints.stations = read_stations();
      options.hints.normals = read_normals(options.hints.slices);
      if (options.number_of_resamples > 0) {
        m_hints = options.hints;
        m_resamples = {skeleton::resample_scan(input,
                                               is_wood,
                                               options.hints.stations,
                                               options.number_of_resamples,
                                               options.hints.normals),
                       options.hints};
      }
      m_session =
          std::make_unique<Session>(std::move(input), std::move(is_wood), std::move(options.hints));
    }
  }

  Tree_skeletonization(Tree_skeletonization&&) = default;
  Tree_skeletonization& operator=(Tree_skeletonization&&) = default;

  /// \name Stages
  /// Each stage returns `false` if the callback stopped it; it may then be called again.
  /// @{

  //! finds neighbours, spacing, duplicates and outliers. O(n log n)
  bool find_neighbors()
  {
    return run([&](auto& p) { return m_session->find_neighbors(p); });
  }
  //! finds ground, root, shortest paths and the tree of level-set components. O(n log n)
  bool find_paths()
  {
    return run([&](auto& p) { return m_session->find_paths(p); });
  }
  //! fits the axes and radii of all branches. O(n log n)
  bool fit_axes()
  {
    return run([&](auto& p) { return m_session->fit_axes(p); });
  }
  //! joins the axes to one rooted tree and fits cross-sections. O(axes log axes)
  bool join()
  {
    return run([&](auto& p) { return m_session->join(p); });
  }

  /*!
    Runs the stages that have not run, and writes the result.

    \tparam Graph `Tree_skeleton<Kernel>`, or any model of `MutableGraph` of Boost with
            `node_point_map` and `node_radius_map` given. It becomes a tree with edges from parent
            to child; the first vertex is the root
    \param tree replaced by the result; unchanged if no tree was found or the callback stopped the
           work
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
      if (!join() || !estimate_spread()) {
        Skeleton_report report;
        report.status = Status::cancelled;
        report.number_of_points = m_session->report().number_of_points;
        return report;
      }
      if (m_session->report().status == Status::converged) {
        if constexpr (is_ready_made)
          skeleton::write_ready_made(m_session->tree(), m_session->scan().frame, tree);
        else
          skeleton::write_graph(m_session->tree(), m_session->scan().frame, m_np, tree);
      }
      write_points();
      if (m_callback)
        m_callback(1);
      Skeleton_report report = m_session->report();
      report.spread = m_resamples.spread();
      report.spread.is_leaf_removal_changed = m_is_leaf_removal_changed;
      report.spread.is_displaced = m_is_displaced;
      if (report.spread.number_of_copies > 0)
        report.spread.fraction = skeleton::resampled_fraction(report.number_of_points);
      return report;
    } else
      return Skeleton_report();
  }

  /// @}

  /// \name Results of the Stages
  /// Coordinates and lengths are those of `scan().frame`, except for the report, which is in the
  /// unit of the input.
  /// @{
  const skeleton::Scan& scan() const { return m_session->scan(); }
  const skeleton::Layer_tree& layers() const { return m_session->layers(); }
  const skeleton::Axis_set& axes() const { return m_session->axes(); }
  const std::vector<skeleton::Joint>& joints() const { return m_session->joints(); }
  const skeleton::Branch_tree& branches() const { return m_session->tree(); }
  const Skeleton_report& report() const { return m_session->report(); }
  /// @}

private:
  static constexpr const char* function = "pcs::extract_tree_skeleton()";

  /// The fraction of the progress at which the stages end if resampled copies follow.
  static constexpr double end_of_stages = 0.5;
  /// The fraction at which a second extraction may follow, see `estimate_spread()`.
  static constexpr double end_of_copies = 0.8, end_of_vote = 0.9;

  template <class Stage>
  bool run(const Stage& stage)
  {
    std::function<bool(double)> callback = m_callback;
    if (callback && !m_resamples.is_done())
      callback = [this](double f) { return m_callback(end_of_stages * f); };
    internal::Progress progress(std::move(callback));
    return stage(progress);
  }

  /// Extracts the skeletons of resampled copies, if there are any. If most of them contradict the
  /// scan in whether there are leaves, extracts the skeleton of the scan again.
  bool estimate_spread()
  {
    if (m_is_spread_done || m_session->report().status != Status::converged)
      return true;
    internal::Progress progress(m_callback);
    if (!m_resamples.is_done()) {
      progress.stage(end_of_stages, end_of_copies);
      if (!m_resamples.run(progress))
        return false;
      const Skeleton_report& r = m_session->report();
      const Leaf_removal vote =
          m_resamples.vote_on_leaves(r.number_of_leaf_points > 0, r.number_of_points);
      m_is_leaf_removal_changed = vote != Leaf_removal::where_found;
      if (m_is_leaf_removal_changed) {
        m_hints.leaf_removal = vote;
        m_session = std::make_unique<Session>(read_points(), read_wood(), m_hints);
      }
    }
    progress.stage(end_of_copies, end_of_vote);
    if (!m_session->join(progress))
      return false;
    progress.stage(end_of_vote, 1);
    m_is_spread_done = choose_typical_skeleton(progress);
    return m_is_spread_done;
  }

  /*!
    If the skeleton of the scan differs from most copies, extracts skeletons of the scan with points
    displaced by a thousandth of their spacing, and keeps the one that differs least. Decisions that
    depend on chance are thus made as in most copies.
  */
  bool choose_typical_skeleton(internal::Progress& progress)
  {
    constexpr std::size_t max_trials = 4;
    constexpr double displacement = 0.001; // spacings
    double least = m_resamples.distance_from_copies(*m_session);
    for (; m_number_of_trials < max_trials && least > 1; ++m_number_of_trials) {
      if (!m_trial) {
        std::vector<skeleton::Vec3> points = read_points();
        skeleton::displace_points(points,
                                  displacement * m_session->report().spacing,
                                  m_number_of_trials + 1);
        m_trial = std::make_unique<Session>(std::move(points), read_wood(), m_hints);
      }
      if (!m_trial->join(progress))
        return false;
      const double distance = m_resamples.distance_from_copies(*m_trial);
      if (distance < least) {
        least = distance;
        m_session = std::move(m_trial);
        m_is_displaced = true;
      }
      m_trial.reset();
    }
    return true;
  }

  std::vector<skeleton::Vec3> read_points() const
  {
    const auto point_map =
        internal::choose(m_np,
                         CGAL::internal_np::point_map,
                         CGAL::Identity_property_map<std::decay_t<typename Types::Element>>());
    return skeleton::internal::read_input(*m_points, point_map, function);
  }

  std::vector<std::uint8_t> read_wood() const
  {
    std::vector<std::uint8_t> is_wood;
    if constexpr (internal::is_given_v<NamedParameters, internal_np::wood_map_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, internal_np::wood_map);
      constexpr bool is_map_ok =
          is_readable_map_v<std::decay_t<decltype(map)>, typename Types::Element, bool>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `wood_map` must be readable, "
                    "accept an element of `points` as key, and store bool");
      std::size_t count = 0;
      is_wood.reserve(static_cast<std::size_t>(std::end(*m_points) - std::begin(*m_points)));
      if constexpr (is_map_ok)
        for (auto it = std::begin(*m_points); it != std::end(*m_points); ++it) {
          is_wood.push_back(get(map, *it) ? 1 : 0);
          count += is_wood.back();
        }
      internal::check(count >= lowest_number_of_scan_points,
                      function,
                      "wood_map leaves " + std::to_string(count) +
                          " points; there must be at least " +
                          std::to_string(lowest_number_of_scan_points));
    }
    return is_wood;
  }

  /// Returns the station of each point, or an empty list if no station is known.
  std::vector<long long> read_stations() const
  {
    std::vector<long long> stations;
    if constexpr (internal::is_given_v<NamedParameters, internal_np::station_map_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, internal_np::station_map);
      using Map = std::decay_t<decltype(map)>;
      constexpr bool is_map_ok =
          is_readable_map_v<Map, typename Types::Element, pcs::Map_value<Map>> &&
          std::is_integral_v<pcs::Map_value<Map>>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `station_map` must be readable, "
                    "accept an element of `points` as key, and store an integer type");
      if constexpr (is_map_ok) {
        const auto begin = std::begin(*m_points), end = std::end(*m_points);
        std::size_t i = 0;
        for (auto it = begin; it != end; ++it, ++i) {
          const long long label = static_cast<long long>(get(map, *it));
          if (label >= 0 && stations.empty())
            stations.assign(static_cast<std::size_t>(end - begin), -1);
          if (label >= 0)
            stations[i] = label;
        }
      }
    }
    return stations;
  }

  /// Returns the normals of the input if `rules` states that there are any. Null vectors and
  /// vectors that are not finite are unknown normals.
  std::vector<skeleton::Vec3> read_normals(const Slice_options& rules) const
  {
    std::vector<skeleton::Vec3> normals;
    if (!rules.has_normals)
      return normals;
    constexpr bool is_given = internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
    bool is_read = false;
    if constexpr (is_given) {
      const auto map = CGAL::parameters::get_parameter(m_np, CGAL::internal_np::normal_map);
      using Map = std::decay_t<decltype(map)>;
      if constexpr (is_readable_point_map_v<Map, typename Types::Element>) {
        is_read = true;
        normals.reserve(static_cast<std::size_t>(std::end(*m_points) - std::begin(*m_points)));
        for (auto it = std::begin(*m_points); it != std::end(*m_points); ++it)
          normals.push_back(skeleton::internal::to_vec3(get(map, *it)));
      }
    }
    internal::check(is_read,
                    function,
                    "slice_options: `has_normals` needs the named parameter `normal_map` with a "
                    "readable map");
    return normals;
  }

  /// Calls `f(i)` for every input point that is assigned to a branch, concurrently if the tag is
  /// parallel.
  template <class F>
  void for_each_explained(const F& f) const
  {
    if (m_session->tree().nodes.empty())
      return;
    internal::for_each_index<ConcurrencyTag>(m_session->report().number_of_points,
                                             [&](std::size_t i) {
                                               if (m_session->node_of_input(i) != skeleton::none)
                                                 f(i);
                                             });
  }

  /// Calls `f(key, i, node)` for every input point in order; `node` is `none` for points that are
  /// not assigned to a branch.
  template <class F>
  void for_each_point(const F& f) const
  {
    const bool has_tree = !m_session->tree().nodes.empty();
    std::size_t i = 0;
    for (auto it = std::begin(*m_points); it != std::end(*m_points); ++it, ++i)
      f(*it, i, has_tree ? m_session->node_of_input(i) : skeleton::none);
  }

  /// Writes the property maps of the points. The caller's maps are written sequentially.
  void write_points() const
  {
    write_branches();
    write_residuals();
    write_leaves();
    write_normals();
    write_densities();
  }

  void write_branches() const
  {
    if constexpr (internal::is_given_v<NamedParameters, internal_np::point_branch_map_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, internal_np::point_branch_map);
      using Map = std::decay_t<decltype(map)>;
      constexpr bool is_map_ok = skeleton::internal::is_index_map_v<Map, typename Types::Element>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `point_branch_map` must be "
                    "writable, accept an element of `points` as key, and store an integer type");
      if constexpr (is_map_ok)
        for_each_point([&](auto&& key, std::size_t, skeleton::Index v) {
          const std::size_t branch =
              v == skeleton::none ? npos : std::size_t(m_session->tree().nodes[v].branch);
          put(map, key, static_cast<pcs::Map_value<Map>>(branch));
        });
    }
  }

  void write_residuals() const
  {
    if constexpr (internal::is_given_v<NamedParameters, internal_np::point_residual_map_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, internal_np::point_residual_map);
      using Map = std::decay_t<decltype(map)>;
      constexpr bool is_map_ok = skeleton::internal::is_length_map_v<Map, typename Types::Element>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `point_residual_map` must be "
                    "writable, accept an element of `points` as key, and store floating point "
                    "numbers");
      if constexpr (is_map_ok) {
        std::vector<double> residuals(m_session->report().number_of_points, 0);
        for_each_explained([&](std::size_t i) { residuals[i] = m_session->residual_of_input(i); });
        for_each_point([&](auto&& key, std::size_t i, skeleton::Index) {
          put(map, key, pcs::Map_value<Map>(residuals[i]));
        });
      }
    }
  }

  void write_leaves() const
  {
    if constexpr (internal::is_given_v<NamedParameters, internal_np::point_is_leaf_map_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, internal_np::point_is_leaf_map);
      constexpr bool is_map_ok =
          is_map_for_v<std::decay_t<decltype(map)>, typename Types::Element, bool>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `point_is_leaf_map` must be "
                    "writable, accept an element of `points` as key, and store bool");
      if constexpr (is_map_ok)
        for_each_point([&](auto&& key, std::size_t i, skeleton::Index) {
          put(map, key, m_session->is_leaf_of_input(i));
        });
    }
  }

  void write_normals() const
  {
    if constexpr (internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, CGAL::internal_np::normal_map);
      using Map = std::decay_t<decltype(map)>;
      constexpr bool is_map_ok = skeleton::internal::is_vector_map_v<Map, typename Types::Element>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `normal_map` must be writable, "
                    "accept an element of `points` as key, and store vectors with x(), y(), z() "
                    "and a constructor from three coordinates");
      if constexpr (is_map_ok) {
        using V = pcs::Map_value<Map>;
        using FT = std::decay_t<decltype(std::declval<const V&>().x())>;
        std::vector<skeleton::Vec3> normals(m_session->report().number_of_points,
                                            skeleton::Vec3::Zero());
        for_each_explained([&](std::size_t i) { normals[i] = m_session->normal_of_input(i); });
        for_each_point([&](auto&& key, std::size_t i, skeleton::Index) {
          const skeleton::Vec3& n = normals[i];
          put(map, key, V(FT(n.x()), FT(n.y()), FT(n.z())));
        });
      }
    }
  }

  void write_densities() const
  {
    if constexpr (internal::is_given_v<NamedParameters, internal_np::point_is_dense_map_t>) {
      const auto map = CGAL::parameters::get_parameter(m_np, internal_np::point_is_dense_map);
      constexpr bool is_map_ok =
          is_map_for_v<std::decay_t<decltype(map)>, typename Types::Element, bool>;
      static_assert(is_map_ok,
                    "pcs::extract_tree_skeleton(): named parameter `point_is_dense_map` must be "
                    "writable, accept an element of `points` as key, and store bool");
      if constexpr (is_map_ok)
        for_each_point([&](auto&& key, std::size_t, skeleton::Index v) {
          put(map, key, v != skeleton::none && m_session->tree().nodes[v].is_measured);
        });
    }
  }

  const PointRange* m_points;
  NamedParameters m_np;
  std::function<bool(double)> m_callback;
  std::unique_ptr<Session> m_session;
  skeleton::Spread_estimator<ConcurrencyTag> m_resamples;
  skeleton::Session_hints m_hints;
  std::unique_ptr<Session> m_trial; ///< see `choose_typical_skeleton()`
  std::size_t m_number_of_trials = 0;
  bool m_is_leaf_removal_changed = false, m_is_displaced = false, m_is_spread_done = false;
};

} // namespace pcs

#endif // PCS_TREE_SKELETONIZATION_H
