// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One tree on the path between two scanned trees.

#ifndef PCS_ORL_GEODESIC_H
#define PCS_ORL_GEODESIC_H

#include <pcs/Orl_shape_space.h>

#include <CGAL/Simple_cartesian.h>

#include <iterator>
#include <type_traits>

namespace pcs {

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief computes the tree at `lambda` on the geodesic from tree `a` (0) to tree `b` (1), or beyond,
      with its points.

  This is equivalent to `add()` for both trees, `build()`, `geodesic()`, `skeleton()` and `points()`
  of an `Orl_shape_space`; see there for the model, errors, cost and determinism. For more than one
  `lambda`, use the class, because nearly all of the time is spent in `build()`.

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \param tree_a, tree_b graphs, see `Orl_shape_space::add()`
  \param scan_a, scan_b points of the trees; may be empty
  \param lambda position on the path, finite [-]
  \param out_tree a `pcs::Tree_skeleton`, or a mutable graph of Boost with `node_point_map` and
      `node_radius_map` in `np`, see `Orl_shape_space::skeleton()`; replaced
  \param out_points a container with `resize()`, replaced
  \param np named parameters of `build()`, `geodesic()` and `points()`; for a graph of Boost, also
      `node_point_map`, `node_radius_map` and `node_branch_map`
  \param np_a, np_b named parameters of `add()` for the trees
  \return the report of `build()`; if its status is `Status::cancelled`, the outputs are unchanged
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class TreeGraphA,
          class PointRangeA,
          class TreeGraphB,
          class PointRangeB,
          class OutTree,
          class OutPointRange,
          class NamedParameters = parameters::Default_named_parameters,
          class NamedParametersA = parameters::Default_named_parameters,
          class NamedParametersB = parameters::Default_named_parameters>
Orl_report orl_geodesic(const TreeGraphA& tree_a,
                        const PointRangeA& scan_a,
                        const TreeGraphB& tree_b,
                        const PointRangeB& scan_b,
                        double lambda,
                        OutTree& out_tree,
                        OutPointRange& out_points,
                        const NamedParameters& np = NamedParameters(),
                        const NamedParametersA& np_a = NamedParametersA(),
                        const NamedParametersB& np_b = NamedParametersB())
{
  constexpr bool is_tree = pcs::internal::is_tree_skeleton_v<OutTree>;
  constexpr bool is_graph = is_tree || pcs::internal::Is_mutable_graph<OutTree>::value;
  static_assert(
      is_graph,
      "pcs::orl_geodesic(): `out_tree` must be a pcs::Tree_skeleton or a mutable graph of "
      "Boost, with add_vertex() and add_edge()");
  Orl_report report;
  if constexpr (is_graph) {
    Orl_shape_space<CGAL::Simple_cartesian<double>, ConcurrencyTag> space;
    const auto a = space.add(tree_a, scan_a, np_a);
    const auto b = space.add(tree_b, scan_b, np_b);
    report = space.build(np);
    if (report.status == Status::cancelled)
      return report;
    const Orl_tree tree = space.geodesic(a, b, lambda, np);
    space.points(tree, out_points, np);
    if constexpr (is_tree)
      space.skeleton(tree, out_tree);
    else {
      Tree_skeleton<CGAL::Simple_cartesian<double>> skeleton;
      space.skeleton(tree, skeleton);
      shape_space::write_graph(skeleton, np, out_tree);
    }
  }
  return report;
}

} // namespace pcs

#endif // PCS_ORL_GEODESIC_H
