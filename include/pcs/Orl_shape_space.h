// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shape space of trees and their scans: distances, geodesics and extrapolation.

#ifndef PCS_ORL_SHAPE_SPACE_H
#define PCS_ORL_SHAPE_SPACE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/core/parameters/result_graph.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/Orl_tree.h>
#include <pcs/shape_space/Space_state.h>
#include <pcs/shape_space/build_space.h>
#include <pcs/shape_space/family/embed_tree.h>
#include <pcs/shape_space/input/check_space.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/input/write_skeleton.h>
#include <pcs/shape_space/path/interpolate_trees.h>
#include <pcs/shape_space/points/write_points.h>
#include <pcs/shape_space/statistics/make_tree.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief A shape space of two trees or more, with the points of their scans.

  The class implements chapter 4 of \cite aiteanu2022. Branches are matched by an elastic energy of
  their curves, and all trees are represented on a common topology. The coordinates of a tree are
  the orientations, radii and lengths (ORL) of the edges of this topology. Distances are sums as in
  (4.7), and geodesics interpolate the coordinates. Points are matched by optimal transport along
  corresponding edges, and move with their edges.

  `add()` copies a tree of any Boost.Graph type and its scan, `build()` finds the correspondences,
  and `geodesic()` computes trees of the space, which are written by `skeleton()` and `points()`.
  Functions for means, modes of variation, random trees, growth and comparison take a built space:
  `mean_tree()`, `find_modes()`, `sample_tree()`, `fit_growth_path()`, `compare_trees.h`.

  A space of two trees represents them exactly. In a space of more than two trees, corresponding
  branches have the same number of nodes, and axes are simplified with a tolerance of 1 % of the
  branch length. Each branch takes its points from one scan, so that the points have the same order
  in all trees. Optimal transport finds the corresponding points in the other scans of the branch.
  The order in which the trees are added does not matter, except for rounding.

  \tparam Kernel a kernel of CGAL; computations are in double precision about a local origin
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \par Errors
  All functions except `add()`, `add_skeleton()`, `build()`, `build_from()` and `restore()` require
  a built space, and throw `pcs::Invalid_input` otherwise.
  \par Determinism
  Results are bitwise identical for every number of threads and for the sequential tag. The order of
  vertices and edges in the graphs has an effect only if branches are exact copies of each other.
  `const` functions may run concurrently.
*/
template <class Kernel = CGAL::Simple_cartesian<double>,
          class ConcurrencyTag = CGAL::Parallel_if_available_tag>
class Orl_shape_space
{
public:
  using FT = typename Kernel::FT;
  using Point_3 = typename Kernel::Point_3;
  using Vector_3 = typename Kernel::Vector_3;
  //! index of an added tree, in the order of addition
  using Handle = std::size_t;

  Orl_shape_space() = default;
  Orl_shape_space(const Orl_shape_space&) = delete;
  Orl_shape_space& operator=(const Orl_shape_space&) = delete;
  Orl_shape_space(Orl_shape_space&&) = default;
  Orl_shape_space& operator=(Orl_shape_space&&) = default;

  /// \name Construction
  //!@{

  /*!
    \brief adds a tree and the points of its scan.

    \tparam TreeGraph a model of `boost::VertexListGraph` and `boost::IncidenceGraph`, edges from
        parent to child
    \param tree a tree with one root, at least 2 nodes, positions at most 1e100 from the root, radii
        in [0, 1e100], and at most 250 levels of branches; coincident nodes are joined
    \param scan a model of `RandomAccessRange`, in the coordinates of the tree; may be empty
    \npbegin
      \np{node_point_map} position of a vertex [L]
        \nptype readable, key: vertex, value with `x()`, `y()`, `z()`
        \npdefault `Tree_node::point`
      \np{node_radius_map} radius of a vertex [L]; 0 if it is not known
        \nptype readable, key: vertex, value: a number
        \npdefault `Tree_node::radius`
      \np{node_index_map} number of a vertex, from 0
        \nptype readable, key: vertex, value: an integer
        \npdefault `get(boost::vertex_index, tree)`
      \np{point_map} position of an element of `scan` [L]
        \nptype readable, value with `x()`, `y()`, `z()`
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} normal of an element. If all scans have normals, trees of the space have
          interpolated normals; otherwise their normals are orthogonal to the branches
        \nptype readable, value with `x()`, `y()`, `z()`
        \npdefault none: normals are estimated at forks
    \npend
    \throws pcs::Invalid_input when an argument violates these conditions; the space is unchanged
    \par Complexity
    Linear in the size of tree and scan, except for the sorting of children.
  */
  template <class TreeGraph,
            class PointRange,
            class NamedParameters = parameters::Default_named_parameters>
  Handle
  add(const TreeGraph& tree, const PointRange& scan, const NamedParameters& np = NamedParameters())
  {
    const char* const caller = "pcs::Orl_shape_space::add()";
    pcs::internal::check(!m_state.is_restored,
                         caller,
                         "the space was restored; add trees to a new one");
    shape_space::Tree_input input =
        shape_space::make_tree_input<Kernel>(tree, scan, np, caller); // may throw
    m_state.inputs.push_back(std::move(input));
    shape_space::Space_state state;
    state.inputs = std::move(m_state.inputs);
    m_state = std::move(state);
    return m_state.inputs.size() - 1;
  }

  //! adds a tree without points
  template <class TreeGraph, class NamedParameters = parameters::Default_named_parameters>
  Handle add_skeleton(const TreeGraph& tree, const NamedParameters& np = NamedParameters())
  {
    return add(tree, std::vector<Point_3>(), np);
  }

  /*!
    \brief finds the correspondences of branches and points, and the coordinates of all trees.

    \npbegin
      \np{matching_weights} weights of the energy of a matching of branches
        \nptype `Matching_weights`
        \npdefault an extended energy; `is_published` selects the published one
      \np{assignment_options} options of the assignment of points to branches
        \nptype `Point_assignment_options`
      \np{transport_options} options of the optimal transport that matches points
        \nptype `Transport_options`
      \np{alignment} whether the second of two trees may be rotated about the vertical
        \nptype `Orl_alignment`
        \npdefault `as_given`; with `rotate_about_up`, the report contains the angle as `yaw`
      \np{up_direction} the vertical
        \nptype a vector with `x()`, `y()`, `z()`, finite and not null
        \npdefault `(0, 0, 1)`
      \np{orientation} frame in which the orientations of edges are measured
        \nptype `Orl_orientation`
        \npdefault `gauge_fixed`; `world_axes` is the published one
      \np{virtual_direction} direction of a branch in a tree that lacks it
        \nptype `Virtual_direction`
        \npdefault `of_partner`; `along_parent` is the published one
      \np{do_use_unit_weights} whether all weights of `Orl_metric::sum` and `square` are 1. Angles
          and the numbers of nodes at attachments are then added to lengths;
          `Orl_metric::published` is (4.7)
        \nptype `bool`
        \npdefault `false`: rotations are multiplied by the length of the edge, so that distances
            are lengths
      \np{number_of_rounds} for more than two trees: number of matching rounds. Each one matches all
          trees to a reference tree with median coordinates
        \nptype an integer, `>= 1`
        \npdefault `3`
      \np{points_of} for more than two trees: the tree whose scan supplies the points of all
          branches that it has
        \nptype `Handle`
        \npdefault none: for each branch, the tree with the most points on it
      \np{callback} progress in [0, 1]; `false` cancels
        \nptype any `bool(double)`
    \npend
    \return a report; with `Status::cancelled` the space is unchanged
    \throws pcs::Invalid_input if fewer than two trees were added, the space was restored, or a
            parameter is out of range
    \par Complexity
    For two trees, the time for matching branches is about proportional to the number of pairs of
    branches of the same order. For more trees, each tree takes this time in each round. An
    alignment about the vertical takes about 5 to 20 times as long if many branches begin at one
    node. The time for n points is \f$O(n \log n)\f$ in practice. The memory is about 100 bytes per
    point of both scans at the peak, and that of the matching, 60 MB for two virtual trees of 900
    branches (see the results of the benchmarks).
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_report build(const NamedParameters& np = NamedParameters())
  {
    const char* const caller = "pcs::Orl_shape_space::build()";
    pcs::internal::check(!m_state.is_restored,
                         caller,
                         "a restored space is already built; add the trees to a new one");
    const shape_space::Build_options options =
        shape_space::read_build_options(np, m_state.inputs.size(), caller);
    std::function<bool(double)> callback;
    pcs::internal::read_callback(np, callback);
    pcs::internal::Progress progress(std::move(callback));
    return shape_space::build_space<ConcurrencyTag>(options, progress, m_state);
  }

  /*!
    \brief builds the space of two trees from correspondences that were computed before.

    The named parameters are `orientation`, `virtual_direction`, `do_use_unit_weights`,
    `matching_weights` (for trees that are embedded later) and `up_direction` (for the sign of the
    yaw), as in `build()`.
    \return a report in which `matching_energy` and `unexplained_fraction` are NaN and
        `is_grown_at_tips` is `false`, because correspondences do not include these values
    \throws pcs::Invalid_input when the correspondences do not fit the trees
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_report build_from(const Orl_correspondences& correspondences,
                        const NamedParameters& np = NamedParameters())
  {
    const char* const caller = "pcs::Orl_shape_space::build_from()";
    const shape_space::Build_options options = shape_space::read_embedding_options(np, caller);
    check_two_inputs(caller);
    return shape_space::build_space_from<ConcurrencyTag>(correspondences, options, caller, m_state);
  }

  /*!
    \brief restores the space from which `data()` was taken; all functions except `add()`,
        `build()`, `build_from()` and `correspondences()` work as before.
    \throws pcs::Invalid_input when the numbers are inconsistent; the space is unchanged
  */
  void restore(const Orl_space_data& stored)
  {
    m_state = shape_space::restore_space<ConcurrencyTag>(stored, "pcs::Orl_shape_space::restore()");
  }
  //!@}

  /// \name Added Trees
  //!@{

  //! number of trees from which the space was built [count]
  std::size_t number_of_trees() const { return family().x.size(); }

  //! an added tree as a tree of the space
  Orl_tree tree(Handle h) const
  {
    check_handle(h, "pcs::Orl_shape_space::tree()");
    std::vector<double> scan_weights(number_of_trees(), 0);
    scan_weights[h] = 1;
    return Orl_tree(
        shape_space::make_tree(family(), family().x[h], h == 1 ? 1 : 0, std::move(scan_weights)));
  }

  //! whether tree `h` has branch `b` of the topology
  bool has_branch(Handle h, std::size_t b) const
  {
    check_handle(h, "pcs::Orl_shape_space::has_branch()");
    return b < family().has[h].size() && family().has[h][b] != 0;
  }

  //! index of the vertex at the tip of branch `b` in the graph of tree `h`; `npos` if the tree
  //! lacks this branch
  std::size_t tip_of_branch(Handle h, std::size_t b) const
  {
    return has_branch(h, b) ? family().tip[h][b] : npos;
  }

  //! pairs of corresponding branches of two trees, with their confidences, parents first
  std::vector<Branch_match> matches() const
  {
    check_two_trees("pcs::Orl_shape_space::matches()");
    std::vector<Branch_match> result;
    for (std::size_t b = 0; b < family().layout.branches.size(); ++b)
      result.push_back({family().layout.branches[b].parent,
                        {family().tip[0][b], family().tip[1][b]},
                        family().confidence[b]});
    return result;
  }

  //! correspondences of two trees, for `build_from()`
  Orl_correspondences correspondences() const
  {
    check_built("pcs::Orl_shape_space::correspondences()");
    check_two_inputs("pcs::Orl_shape_space::correspondences()");
    return shape_space::store_correspondences<ConcurrencyTag>(m_state);
  }

  //! the whole space as plain data, for `IO::write_shape_space()`
  Orl_space_data data() const
  {
    check_built("pcs::Orl_shape_space::data()");
    return shape_space::store_space<ConcurrencyTag>(m_state);
  }

  /*!
    \brief represents a further tree, which was not added, in the space.

    The tree is matched to the reference tree of the space. Its branches without correspondence are
    left out.
    \param tree, np as for `add()`
    \param represented if not null, receives the fraction of the length of `tree` that is
        represented [-]
  */
  template <class TreeGraph, class NamedParameters = parameters::Default_named_parameters>
  Orl_tree embed(const TreeGraph& tree,
                 const NamedParameters& np = parameters::default_values(),
                 double* represented = nullptr) const
  {
    check_built("pcs::Orl_shape_space::embed()");
    const shape_space::Tree_input input =
        shape_space::make_tree_input<Kernel>(tree,
                                             std::vector<Point_3>(),
                                             np,
                                             "pcs::Orl_shape_space::embed()");
    return Orl_tree(shape_space::make_tree(
        family(),
        shape_space::embed_tree<ConcurrencyTag>(family(), input.tree, represented)));
  }

  //! topology, coordinates and metric of all trees; empty before `build()`
  const shape_space::Tree_family& family() const { return m_state.family; }
  //!@}

  /// \name Distance and Geodesic
  //!@{

  /*!
    \brief returns the distance between two trees of the space [L].

    \npbegin
      \np{metric} how differences of coordinates are combined
        \nptype `Orl_metric`
        \npdefault `sum`; `published` is (4.7), in which angles [rad] and lengths [L] are added. Its
            orientations are the published ones if the space was built with
            `Orl_orientation::world_axes`
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  double distance(const Orl_tree& a,
                  const Orl_tree& b,
                  const NamedParameters& np = NamedParameters()) const
  {
    const Orl_metric metric = shape_space::read_metric(np);
    check_tree(a, "pcs::Orl_shape_space::distance()");
    check_tree(b, "pcs::Orl_shape_space::distance()");
    return shape_space::distance(a.coordinates(), b.coordinates(), family().weights, metric);
  }
  //! returns the distance between two added trees [L]
  template <class NamedParameters = parameters::Default_named_parameters>
  double distance(Handle a, Handle b, const NamedParameters& np = NamedParameters()) const
  {
    const Orl_metric metric = shape_space::read_metric(np);
    check_handle(a, "pcs::Orl_shape_space::distance()");
    check_handle(b, "pcs::Orl_shape_space::distance()");
    return shape_space::distance(family().x[a], family().x[b], family().weights, metric);
  }

  /*!
    \brief returns the tree at `lambda` on the geodesic from `a` (0) to `b` (1), or beyond its ends.

    Beyond the ends, by default, lengths and radii remain positive. Edges rotate by at most
    `max_extrapolation_angle`, both relative to their parent edge and in space. The extrapolation of
    a branch is reduced if the branch would extend below the base of the tree (against the direction
    of growth). This does not apply to branches that extend below the base at one of the ends.

    \npbegin
      \np{max_extrapolation_angle} largest rotation of an edge beyond an end of the path [rad]
        \nptype `double`, `>= 0`; there is no limit if it is pi or more
        \npdefault `pi / 4`
      \np{extrapolation} how lengths and radii continue beyond the ends
        \nptype `Orl_extrapolation`
        \npdefault `bounded`; `linear` is the published one
      \np{do_limit_radii} whether the base radius of a branch is limited to the radius of its parent
        \nptype `bool`
        \npdefault `false`, since real trees violate this rule
      \np{branch_emergence} how the branches that only one of the trees has emerge
        \nptype `Branch_emergence`
        \npdefault `simultaneous`: coordinates are linear; `sequential` suits trees that grow at
            their tips
    \npend
    \throws pcs::Invalid_input when `lambda` is not finite or so large that coordinates would not be
        finite, or when a handle is invalid
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree
  geodesic(Handle a, Handle b, double lambda, const NamedParameters& np = NamedParameters()) const
  {
    Orl_tree result;
    geodesic(a, b, lambda, result, np);
    return result;
  }

  //! computes the same tree, and reuses the memory of `result`
  template <class NamedParameters = parameters::Default_named_parameters>
  void geodesic(Handle a,
                Handle b,
                double lambda,
                Orl_tree& result,
                const NamedParameters& np = NamedParameters()) const
  {
    const char* const caller = "pcs::Orl_shape_space::geodesic()";
    const shape_space::Path_options options = shape_space::read_path_options(np, caller);
    check_handle(std::max(a, b), caller);
    if (a == b && std::isfinite(lambda))
      lambda = 0;
    shape_space::Tree_state& state = result.state();
    if (!m_state.is_pair()) {
      state.scan_weights.assign(number_of_trees(), 0);
      const double weight = std::min(1.0, std::max(0.0, a == b ? 0.0 : lambda));
      state.scan_weights[a] += 1 - weight;
      state.scan_weights[b] += weight;
    }
    // always from the lower to the higher handle, so that both directions give identical trees
    const double t = a <= b ? lambda : 1 - lambda;
    interpolate(family().x[std::min(a, b)], family().x[std::max(a, b)], t, options, state);
    state.lambda = a != b ? t : a == 1 ? 1 : 0;
  }

  //! returns the tree at `lambda` on the geodesic from tree `a` of the space to tree `b`
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree geodesic(const Orl_tree& a,
                    const Orl_tree& b,
                    double lambda,
                    const NamedParameters& np = NamedParameters()) const
  {
    const char* const caller = "pcs::Orl_shape_space::geodesic()";
    const shape_space::Path_options options = shape_space::read_path_options(np, caller);
    check_tree(a, caller);
    check_tree(b, caller);
    const double weight = std::min(1.0, std::max(0.0, lambda));
    shape_space::Tree_state result;
    shape_space::mix_scan_weights(family(), {&a.state(), &b.state()}, {1 - weight, weight}, result);
    interpolate(a.coordinates(), b.coordinates(), lambda, options, result);
    result.lambda = (1 - lambda) * a.lambda() + lambda * b.lambda();
    return Orl_tree(std::move(result));
  }
  //!@}

  /// \name Skeletons and Points
  //!@{

  /*!
    \brief writes a tree of the space as a skeleton.

    A branch that the tree lacks (its length is 0) is left out with its subtree. Parts of a branch
    without length have no nodes of their own. Lengths up to 1e-9 of the extent of the tree count as
    0; nodes so close are also joined when a tree is read. Every branch begins with a separate node
    on the axis of its parent, which has the base radius of the branch; no other two consecutive
    nodes are in one place.

    \param result receives the skeleton; its contents are replaced
    \npbegin
      \np{do_keep_absent_branches} whether branches and parts of branches without length are written
          as well, as nodes in one place, which may have the radius 0
        \nptype `bool`
        \npdefault `false`
    \npend
    \throws pcs::Invalid_input when `t` has another number of branches or edges than this space
    \par Complexity
    O(n log n) for n nodes of all trees of the space.
  */
  template <class OutKernel, class NamedParameters = parameters::Default_named_parameters>
  void skeleton(const Orl_tree& t,
                Tree_skeleton<OutKernel>& result,
                const NamedParameters& np = NamedParameters()) const
  {
    const bool do_keep = shape_space::read_do_keep_absent_branches(np);
    check_tree(t, "pcs::Orl_shape_space::skeleton()");
    const shape_space::Orl_geometry& geometry = t.state().geometry;
    shape_space::write_skeleton(family().layout,
                                t.coordinates(),
                                geometry,
                                family().origin,
                                do_keep ? -1 : shape_space::internal::least_length(geometry),
                                result);
  }

  /*!
    \brief writes a tree of the space to a graph of the caller, as the function above.

    \tparam Graph a mutable graph of Boost, with edges from parent to child
    \param result receives the skeleton; its vertices and edges are replaced. Vertices are added in
        the order of the function above, parents first
    \npbegin
      \np{node_point_map} where the position of a vertex is written [L]
        \nptype writable, key: vertex, value: a point with `x()`, `y()`, `z()`
        \npdefault none: it is required
      \np{node_radius_map} where the radius of a vertex is written [L]
        \nptype writable, key: vertex, value: a floating-point number
        \npdefault none: it is required
      \np{node_branch_map} where the number of the branch of a vertex is written; 0 is the trunk
        \nptype writable, key: vertex, value: an integer
        \npdefault none
      \np{do_keep_absent_branches} as above
        \nptype `bool`
        \npdefault `false`
    \npend
    \throws pcs::Invalid_input as above; the graph is unchanged. It is empty if memory runs out
        while it is written
  */
  template <class Graph, class NamedParameters = parameters::Default_named_parameters>
  std::enable_if_t<!pcs::internal::is_tree_skeleton_v<Graph>>
  skeleton(const Orl_tree& t, Graph& result, const NamedParameters& np = NamedParameters()) const
  {
    constexpr bool is_graph = pcs::internal::Is_mutable_graph<Graph>::value;
    static_assert(is_graph,
                  "pcs::Orl_shape_space::skeleton(): the result must be a pcs::Tree_skeleton or a "
                  "mutable graph of Boost, with add_vertex() and add_edge()");
    if constexpr (is_graph) {
      Tree_skeleton<CGAL::Simple_cartesian<double>> tree;
      skeleton(t,
               tree,
               parameters::do_keep_absent_branches(shape_space::read_do_keep_absent_branches(np)));
      pcs::internal::write_or_clear(result, [&] { shape_space::write_graph(tree, np, result); });
    }
  }

  /*!
    \brief writes the points of a tree of the space.

    Points are sorted by edge. Points of branches that the tree lacks are left out. In a space of
    two trees, the points at `lambda` 0 and 1 are the points of the scans; each of them appears once
    per correspondence. If both trees have a branch but only one scan has points on it, these points
    are present along the whole path.

    \param result a random access range; a container with `resize()` is resized to
           `t.number_of_points()`, without allocation if its capacity suffices; any other range must
           have at least this size
    \npbegin
      \np{point_map} where a position is written
        \nptype model of `WritablePropertyMap`, key: element of `result`, value: `Kernel::Point_3`
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} where a normal is written
        \nptype model of `WritablePropertyMap`, value: `Kernel::Vector_3`
        \npdefault none
      \np{point_normals} which normals are written
        \nptype `Point_normals`
        \npdefault `of_scans` if all scans have normals, otherwise `across_branches`: orthogonal to
            the direction of the branch
      \np{point_path} how points are interpolated; only in a space of two trees
        \nptype `Point_path`
        \npdefault `cylindrical`; `virtual_edges` is the published one
    \npend
    \return the number of points
    \par Complexity
    Linear in the number of points; no allocation.
  */
  template <class PointRange, class NamedParameters = parameters::Default_named_parameters>
  std::size_t
  points(const Orl_tree& t, PointRange& result, const NamedParameters& np = NamedParameters()) const
  {
    const char* const caller = "pcs::Orl_shape_space::points()";
    const Point_path path = shape_space::read_point_path(np, m_state.is_pair(), caller);
    check_tree(t, caller);
    constexpr bool is_range = is_random_access_range_v<PointRange>;
    static_assert(is_range,
                  "pcs::Orl_shape_space::points(): `result` must be a random access range");
    if constexpr (is_range) {
      using Key = Element_reference<PointRange>;
      const auto point_map =
          pcs::internal::choose(np,
                                CGAL::internal_np::point_map,
                                CGAL::Identity_property_map<std::decay_t<Key>>());
      constexpr bool has_normals =
          pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
      const auto normal_map =
          pcs::internal::choose(np, CGAL::internal_np::normal_map, shape_space::No_map());
      constexpr bool is_point_map = is_writable_point_map_v<std::decay_t<decltype(point_map)>, Key>;
      constexpr bool is_normal_map =
          !has_normals || is_writable_point_map_v<std::decay_t<decltype(normal_map)>, Key>;
      static_assert(is_point_map,
                    "pcs::Orl_shape_space::points(): named parameter `point_map` must be writable, "
                    "with elements of `result` as keys and points as values");
      static_assert(is_normal_map,
                    "pcs::Orl_shape_space::points(): named parameter `normal_map` must be "
                    "writable, with elements of `result` as keys and vectors as values");
      const Point_normals normals =
          shape_space::read_point_normals(np, m_state.has_normals(), caller);
      shape_space::internal::resize_range(result, t.number_of_points(), caller);
      if constexpr (is_point_map && is_normal_map)
        write_points(
            t.state(),
            path,
            has_normals && normals == Point_normals::across_branches,
            shape_space::Point_writer<std::decay_t<decltype(std::begin(result))>,
                                      std::decay_t<decltype(point_map)>,
                                      std::decay_t<decltype(normal_map)>>{std::begin(result),
                                                                          point_map,
                                                                          normal_map,
                                                                          family().origin});
    }
    return t.number_of_points();
  }

  /*!
    \brief calls `f(i, a, b, w)` for every point of a tree of a space of two trees.

    Point `i` is interpolated between point `a` of the first scan and point `b` of the second one;
    an index is `npos` if there is no such point. `w` in [0, 1] is the weight of the second point.
    Attributes are interpolated by `result[i] = (1 - w) * one[a] + w * two[b]`. `f` may be called
    concurrently.
  */
  template <class F>
  void for_each_point(const Orl_tree& t, const F& f) const
  {
    constexpr bool is_callable =
        std::is_invocable_v<const F&, std::size_t, std::size_t, std::size_t, double>;
    static_assert(
        is_callable,
        "pcs::Orl_shape_space::for_each_point(): `f` must take the numbers of a point and "
        "of its two sources, and a weight");
    check_two_trees("pcs::Orl_shape_space::for_each_point()");
    check_tree(t, "pcs::Orl_shape_space::for_each_point()");
    const double weight = std::min(1.0, std::max(0.0, t.lambda()));
    if constexpr (is_callable)
      m_state.pair.instances.for_each_pair(
          t.coordinates(),
          t.state().first_point,
          [&](std::size_t i, const shape_space::Point_pair& pair) {
            const bool has_a = pair.point[0] != shape_space::no_point;
            const bool has_b = pair.point[1] != shape_space::no_point;
            f(i,
              has_a ? std::size_t(pair.point[0]) : npos,
              has_b ? std::size_t(pair.point[1]) : npos,
              has_a ? (has_b ? weight : 0.0) : 1.0);
          },
          ConcurrencyTag());
  }

  /*!
    \brief calls `f(i, h, k, w)` for every point of a tree and each of its source points. The space
        must have more than two trees.

    A source is point `k` of the scan of tree `h`. Its weight `w` is in (0, 1], and the weights of
    all sources of point `i` add up to 1. Attributes are interpolated by
    `result[i] += w * scan[h][k]`. `f` may be called concurrently, but not for the same `i`.
  */
  template <class F>
  void for_each_source(const Orl_tree& t, const F& f) const
  {
    constexpr bool is_callable =
        std::is_invocable_v<const F&, std::size_t, std::size_t, std::size_t, double>;
    static_assert(
        is_callable,
        "pcs::Orl_shape_space::for_each_source(): `f` must take the numbers of a point, a "
        "tree and a point of its scan, and a weight");
    check_tree(t, "pcs::Orl_shape_space::for_each_source()");
    pcs::internal::check(!m_state.is_pair(),
                         "pcs::Orl_shape_space::for_each_source()",
                         "points of two trees come from both; use for_each_point()");
    const std::vector<std::size_t>& first = m_state.family_points.first();
    const shape_space::Tree_state& tree = t.state();
    if constexpr (is_callable)
      pcs::internal::for_each_index<ConcurrencyTag>(
          tree.x.length.size(),
          [&](std::size_t e) {
            if (tree.x.length[e] > 0)
              for (std::size_t k = first[e]; k < first[e + 1]; ++k)
                m_state.family_points.for_each_source(
                    k,
                    tree.scan_weights,
                    [&](std::size_t h, std::size_t point, double w) {
                      f(tree.first_point[e] + k - first[e], h, point, w);
                    });
          },
          64);
  }

  //! whether trees of the space have points
  bool has_points() const
  {
    return !family().first_point.empty() && family().first_point.back() > 0;
  }
  //! whether all scans have normals, which `points()` then interpolates
  bool has_normals() const { return m_state.has_normals(); }
  //!@}

private:
  void check_built(const char* caller) const { shape_space::check_built(family(), caller); }
  void check_handle(Handle h, const char* caller) const
  {
    shape_space::check_handle(family(), h, caller);
  }
  void check_tree(const Orl_tree& t, const char* caller) const
  {
    shape_space::check_tree(family(), t.coordinates(), t.state().scan_weights, caller);
  }
  void check_two_trees(const char* caller) const
  {
    check_built(caller);
    if (!m_state.is_pair())
      throw Invalid_input(std::string(caller) + ": the space has " +
                          std::to_string(number_of_trees()) +
                          " trees; this function requires a space of two trees");
  }
  void check_two_inputs(const char* caller) const
  {
    pcs::internal::check(!m_state.is_restored,
                         caller,
                         "the space was restored without its trees; add them to a new space");
    pcs::internal::check(m_state.inputs.size() == 2,
                         caller,
                         std::to_string(m_state.inputs.size()) + " trees were added, expected 2");
  }

  void interpolate(const shape_space::Orl_coordinates& a,
                   const shape_space::Orl_coordinates& b,
                   double t,
                   const shape_space::Path_options& options,
                   shape_space::Tree_state& result) const
  {
    const char* const caller = "pcs::Orl_shape_space::geodesic()";
    pcs::internal::check(std::isfinite(t), caller, "`lambda` is not finite");
    shape_space::interpolate_trees(family(), a, b, t, options, caller, result);
  }

  template <class Writer>
  void write_points(const shape_space::Tree_state& t,
                    Point_path path,
                    bool are_normals_across,
                    const Writer& writer) const
  {
    if (m_state.is_pair())
      m_state.pair.instances.write(family().layout,
                                   t.x,
                                   t.geometry,
                                   t.lambda,
                                   path,
                                   are_normals_across,
                                   t.first_point,
                                   writer,
                                   ConcurrencyTag());
    else
      m_state.family_points.write(family().layout,
                                  t.x,
                                  t.geometry,
                                  t.first_point,
                                  t.scan_weights,
                                  are_normals_across,
                                  writer,
                                  ConcurrencyTag());
  }

  shape_space::Space_state m_state;
};

} // namespace pcs

#endif // PCS_ORL_SHAPE_SPACE_H
