// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A space in which trees are points: distance, geodesic and extrapolation between trees, with their
// scans.

#ifndef PCS_ORL_SHAPE_SPACE_H
#define PCS_ORL_SHAPE_SPACE_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_tree.h>
#include <pcs/Orl_tree_paths.h>
#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_report.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/internal/Stopwatch.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/Space_engine.h>
#include <pcs/shape_space/input/read_options.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/pair/Embedded_pair.h>

#include <CGAL/Simple_cartesian.h>

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief A shape space of two trees or more, with the points of their scans.

  Follows chapter 4 of \cite aiteanu2022: branches are matched by elastic curves, both trees get one
  topology, points are matched by optimal transport along corresponding edges, and a tree is the
  list of orientations, radii and lengths (ORL) of the edges of the topology. Distances are those of
  (4.7), geodesics interpolate the coordinates; points follow their edges.

  Trees of any Boost.Graph type are added, then `build()` finds the correspondences, then trees of
  the space are made by `geodesic()` and turned into skeletons and points. Inputs are copied,
  nothing refers to them afterwards.

  Two trees are represented exactly. More trees share the nodes of their branches: axes are
  straightened between them, by `shape_space::axis_tolerance` of the length of a branch at most.
  Each branch has as many points as in one scan, so that points have the same order in all trees;
  each of them has a partner in every other scan of the branch, found by transport, and lies between
  these. The order in which trees are added does not matter then, save for rounding. See the base
  class for means, modes and new trees.

  \tparam Kernel a kernel of CGAL; computations are in double precision about a local origin
  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \par Determinism
  Same bits for every number of threads and for the sequential tag. The order of vertices and edges
  in the graphs does not matter, save for exact copies of branches.
*/
template <class Kernel = CGAL::Simple_cartesian<double>,
          class ConcurrencyTag = CGAL::Parallel_if_available_tag>
class Orl_shape_space : public Orl_tree_paths<ConcurrencyTag>
{
  using Paths = Orl_tree_paths<ConcurrencyTag>;
  using Engine = typename Paths::Engine;

public:
  using FT = typename Kernel::FT;
  using Point_3 = typename Kernel::Point_3;
  using Vector_3 = typename Kernel::Vector_3;
  //! names an added tree
  using Handle = typename Paths::Handle;

  Orl_shape_space() = default;
  Orl_shape_space(const Orl_shape_space&) = delete;
  Orl_shape_space& operator=(const Orl_shape_space&) = delete;
  Orl_shape_space(Orl_shape_space&&) = default;
  Orl_shape_space& operator=(Orl_shape_space&&) = default;

  /*!
    \brief adds a tree and the points of its scan.

    \tparam TreeGraph a model of `boost::VertexListGraph` and `boost::IncidenceGraph`, edges from
        parent to child
    \param tree with one root, at least 2 nodes, positions up to 1e100 from it and radii in [0,
        1e100], branches that hang on
    others 250 times at most; nodes in the same place are joined
    \param scan a model of `RandomAccessRange`; may be empty; it should lie about the tree
    \npbegin
      \np{node_point_map} position of a vertex [L]
        \nptype readable, key: vertex, value with `x()`, `y()`, `z()`
        \npdefault `Tree_node::point`
      \np{node_radius_map} radius of a vertex [L]; 0 where it is not known
        \nptype readable, key: vertex, value: a number
        \npdefault `Tree_node::radius`
      \np{node_index_map} number of a vertex, from 0
        \nptype readable, key: vertex, value: an integer
        \npdefault `get(boost::vertex_index, tree)`
      \np{point_map} position of an element of `scan` [L]
        \nptype readable, value with `x()`, `y()`, `z()`
        \npdefault `CGAL::Identity_property_map`
      \np{normal_map} normal of an element; given for both trees, instances have normals
        \nptype readable, value with `x()`, `y()`, `z()`
        \npdefault none: normals are estimated at forks
    \npend
    \throws pcs::Invalid_input when a rule is broken; the space is unchanged then
    \par Complexity
    Linear in the size of tree and scan, but for the sorting of children.
  */
  template <class TreeGraph,
            class PointRange,
            class NamedParameters = parameters::Default_named_parameters>
  Handle
  add(const TreeGraph& tree, const PointRange& scan, const NamedParameters& np = NamedParameters())
  {
    if (m_is_restored)
      throw Invalid_input(
          "pcs::Orl_shape_space::add(): the space was restored; add trees to a new one");
    m_inputs.push_back(
        shape_space::make_tree_input<Kernel>(tree, scan, np, "pcs::Orl_shape_space::add()"));
    this->m_is_built = false;
    this->m_family = shape_space::Tree_family();
    return m_inputs.size() - 1;
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
      \np{matching_weights} of the energy of matching branches
        \nptype `Matching_weights`
        \npdefault changed energy; `is_published` gives the text's
      \np{assignment_options} of points to branches
        \nptype `Point_assignment_options`
      \np{transport_options} of the correspondence of points: exact or by Sinkhorn's algorithm, how
        far mass is carried, and sizes
        \nptype `Transport_options`
      \np{alignment} whether the second of two trees may stand turned about the vertical
        \nptype `Orl_alignment`
        \npdefault `as_given`: both stand in the same axes; with `turns` the branches tell, and the
            report has the turn
      \np{up_direction} the vertical
        \nptype a vector with `x()`, `y()`, `z()`, finite and not null
        \npdefault `(0, 0, 1)`
      \np{orientation} how orientations are measured
        \nptype `Orl_orientation`
        \npdefault `gauge_fixed`; `world_axes` is the text's
      \np{virtual_direction} where branches without partner point
        \nptype `Virtual_direction`
        \npdefault `of_partner`; `along_parent` is the text's
      \np{do_use_unit_weights} whether all weights of the metric are 1, as in the text
        \nptype `bool`
        \npdefault `false`: turns count with the length of the edge, so that distances are lengths
      \np{number_of_rounds} for more than two trees: how often all are matched to a tree in their
          middle
        \nptype an integer, `>= 1`
        \npdefault `3`
      \np{points_of} for more than two trees: the tree whose scan gives the points of the branches
        that it has, to which those of other scans are matched
        \nptype `Handle`
        \npdefault none: for each branch, the tree with most points there
      \np{callback} progress in [0, 1]; `false` cancels
        \nptype any `bool(double)`
    \npend
    \return a report; with `Status::cancelled` the space is as before
    \throws pcs::Invalid_input unless two trees were added at least
    \par Complexity
    Branches: about the number of pairs of branches on the same level, for more than two trees once
    per tree and round. Points: \f$O(n \log n)\f$ in practice.
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_report build(const NamedParameters& np = NamedParameters())
  {
    using namespace shape_space;
    if (m_is_restored)
      throw Invalid_input("pcs::Orl_shape_space::build(): the space was restored, it is built");
    const Build_options options =
        read_options(np, m_inputs.size(), "pcs::Orl_shape_space::build()");
    pcs::internal::Progress progress(
        pcs::internal::choose(np, CGAL::internal_np::callback, std::function<bool(double)>()));
    Orl_report report = new_report();
    if (m_inputs.size() > 2)
      return build_many(np, options, progress);
    Embedded_pair built;
    read_form(np, built);
    std::vector<Point_pair> pairs;
    if (!Engine::find_correspondences(inputs(), options, progress, built, pairs, report))
      return cancelled(report);
    pcs::internal::Stopwatch watch;
    finish(built, std::move(pairs), options.weights, report);
    report.seconds.instances = watch.lap();
    progress.finish();
    return report;
  }

  /*!
    \brief the same with correspondences that were computed before, for the same trees with the same
        points, or none.

    Reads `orientation`, `virtual_direction` and `do_use_unit_weights`, `matching_weights` for trees
    that are embedded later, and `up_direction` for the sign of the turn.
    \return a report in which `matching_energy` and `unexplained_share` are not numbers, and
        `is_grown_at_tips` is `false`: the
    correspondences do not tell
    \throws pcs::Invalid_input when the correspondences do not fit the trees
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_report build_from(const Orl_correspondences& correspondences,
                        const NamedParameters& np = NamedParameters())
  {
    check_inputs("build_from");
    const shape_space::Build_options options =
        shape_space::read_options(np, m_inputs.size(), "pcs::Orl_shape_space::build_from()");
    Orl_report report = new_report();
    report.matching_energy = report.unexplained_share = std::numeric_limits<double>::quiet_NaN();
    pcs::internal::Stopwatch watch;
    shape_space::Embedded_pair built;
    shape_space::read_form(np, built);
    Engine::embed_stored(correspondences, inputs(), "pcs::Orl_shape_space::build_from()", built);
    report.turn = shape_space::angle_about(options.standing.up, built.turn);
    report.seconds.topology = watch.lap();
    const bool has_points = !m_inputs[0].points.empty() || !m_inputs[1].points.empty();
    finish(built,
           has_points ? correspondences.pairs : std::vector<shape_space::Point_pair>(),
           options.weights,
           report);
    report.seconds.instances = watch.lap();
    return report;
  }

  //! what `build()` found, to be kept; \pre it was built
  Orl_correspondences correspondences() const
  {
    this->check_built("correspondences");
    check_inputs("correspondences");
    return Engine::store_topology(this->m_built, inputs());
  }

  //! branches that correspond, parents first; \pre it was built
  std::vector<Branch_match> matches() const
  {
    this->check_built("matches");
    this->check_two("matches");
    std::vector<Branch_match> result;
    for (std::size_t b = 0; b < this->m_family.layout.branches.size(); ++b) {
      Branch_match match;
      match.parent = this->m_family.layout.branches[b].parent;
      for (std::size_t t = 0; t < 2; ++t)
        match.tip[t] = this->m_family.tip[t][b];
      result.push_back(match);
    }
    return result;
  }

  /*!
    \brief a tree that was not added, as a tree of the space.

    It is matched to a tree in the middle of the added ones; its branches that find no partner are
    left out.
    \param tree, np as for `add()`
    \param share if not null: the share of its length that is represented [-]
  */
  template <class TreeGraph, class NamedParameters = parameters::Default_named_parameters>
  Orl_tree embed(const TreeGraph& tree,
                 const NamedParameters& np = parameters::default_values(),
                 double* share = nullptr) const
  {
    this->check_built("embed");
    const shape_space::Tree_input input =
        shape_space::make_tree_input<Kernel>(tree,
                                             std::vector<Point_3>(),
                                             np,
                                             "pcs::Orl_shape_space::embed()");
    return this->make(Engine::embed_tree(this->m_family, input.tree, share));
  }

  //! the whole space as numbers, for `IO::write_shape_space()`; \pre it was built
  Orl_space_data data() const
  {
    this->check_built("data");
    Orl_space_data result = Engine::store_family(this->m_family);
    result.points = m_stored_points;
    result.partners = m_stored_partners;
    result.has_normals = this->has_normals();
    if (this->is_pair()) {
      result.pairs = this->m_built.instances.pairs();
      Engine::store_points(inputs(), result);
    }
    return result;
  }

  /*!
    \brief makes the space that `data()` was taken from; all but `correspondences()`, `add()` and
        `build()` works as before.
    \throws pcs::Invalid_input when the numbers do not make sense; the space is unchanged then
  */
  void restore(const Orl_space_data& stored)
  {
    Orl_shape_space space;
    space.m_family = Engine::restore_family(stored, "pcs::Orl_shape_space::restore()");
    space.set_points(stored);
    space.m_is_built = space.m_is_restored = true;
    *this = std::move(space);
  }

private:
  std::array<const shape_space::Tree_input*, 2> inputs() const
  {
    return {&m_inputs[0], &m_inputs[1]};
  }

  void check_inputs(const char* caller) const
  {
    if (m_is_restored)
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): the space was restored, the trees themselves are not there");
    if (m_inputs.size() != 2)
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller + "(): " +
                          std::to_string(m_inputs.size()) + " trees were added, expected 2");
  }
  Orl_report new_report() const
  {
    Orl_report report;
    report.number_of_trees = m_inputs.size();
    for (std::size_t t = 0; t < 2; ++t) {
      report.number_of_nodes[t] = m_inputs[t].tree.node_of_source.size();
      report.number_of_points[t] = m_inputs[t].points.size();
    }
    return report;
  }
  static Orl_report cancelled(Orl_report report)
  {
    report.status = Status::cancelled;
    return report;
  }

  void finish(shape_space::Embedded_pair& built,
              std::vector<shape_space::Point_pair> pairs,
              const Matching_weights& weights,
              Orl_report& report)
  {
    this->m_family = Engine::finish_pair(inputs(), std::move(pairs), weights, built, report);
    this->m_built = std::move(built);
    this->m_points = shape_space::Family_points();
    m_stored_points.clear();
    m_stored_partners.clear();
    this->m_is_built = true;
    report.status = Status::converged;
  }

  template <class NamedParameters>
  Orl_report build_many(const NamedParameters& np,
                        const shape_space::Build_options& options,
                        pcs::internal::Progress& progress)
  {
    Orl_report report = new_report();
    shape_space::Embedded_pair form;
    shape_space::read_form(np, form);
    shape_space::Built_family built;
    built.family.orientation = form.orientation;
    if (!Engine::build_family(m_inputs,
                              options,
                              form.direction,
                              form.has_unit_weights,
                              progress,
                              built,
                              report))
      return cancelled(report);
    pcs::internal::Stopwatch watch;
    this->m_family = std::move(built.family);
    this->m_built = shape_space::Embedded_pair();
    set_family_points(std::move(built.points), std::move(built.partners), built.has_normals);
    this->m_is_built = true;
    report.seconds.instances = watch.lap();
    report.status = Status::converged;
    report.distance = this->distance(Handle(0), Handle(1));
    report.number_of_point_pairs = this->m_points.size();
    progress.finish();
    return report;
  }

  /// Points of a space of more than two trees, by edge.
  void set_family_points(std::vector<Orl_space_data::Point> points,
                         std::vector<Orl_space_data::Partner> partners,
                         bool has_normals)
  {
    Engine::set_points(points, partners, has_normals, this->m_family, this->m_points);
    m_stored_points = std::move(points);
    m_stored_partners = std::move(partners);
  }

  /// What `data()` gave, once the family is there.
  void set_points(const Orl_space_data& stored)
  {
    const char* const caller = "pcs::Orl_shape_space::restore()";
    if (this->number_of_trees() > 2) {
      Engine::check_family_points(stored, this->m_family.layout.number_of_edges(), caller);
      set_family_points(stored.points, stored.partners, stored.has_normals);
      return;
    }
    m_inputs = Engine::restore_pair(stored, caller, this->m_family, this->m_built);
  }

  std::vector<shape_space::Tree_input> m_inputs;
  std::vector<Orl_space_data::Point> m_stored_points; // of more than two trees
  std::vector<Orl_space_data::Partner> m_stored_partners;
  bool m_is_restored = false;
};

} // namespace pcs

#endif // PCS_ORL_SHAPE_SPACE_H
