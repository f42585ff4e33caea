// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the result to a graph of the caller, in coordinates and units of the input.

#ifndef PCS_SKELETON_RESULT_WRITE_RESULT_H
#define PCS_SKELETON_RESULT_WRITE_RESULT_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/result_graph.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Scan_frame.h>

#include <boost/graph/graph_traits.hpp>

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Fills a `Tree_skeleton` with all attributes of nodes and branches.
template <class Graph>
void write_ready_made(const Branch_tree& found, const Scan_frame& frame, Graph& tree)
{
  using Node = typename Graph::vertex_bundled;
  using FT = typename Node::FT;
  using P = typename Node::Point_3;
  using V = typename Node::Vector_3;
  tree = Graph();
  for (const Branch_node& from : found.nodes) {
    Node node;
    const Vec3 p = frame.to_input(from.point);
    node.point = P(FT(p.x()), FT(p.y()), FT(p.z()));
    node.radius = FT(frame.unit * from.radius);
    node.radius_error = FT(frame.unit * from.radius_error);
    node.is_measured = from.is_measured;
    const bool is_oval = from.major_radius > 0;
    node.major_radius = FT(frame.unit * (is_oval ? from.major_radius : from.radius));
    node.minor_radius = FT(frame.unit * (is_oval ? from.minor_radius : from.radius));
    const Vec3 major = frame.direction_to_input(from.major_axis);
    node.major_axis = V(FT(major.x()), FT(major.y()), FT(major.z()));
    node.branch = from.branch;
    const auto v = add_vertex(node, tree);
    if (from.parent != none)
      add_edge(from.parent, v, tree);
  }
  Tree_bundle bundle;
  bundle.root = 0;
  for (std::size_t b = 0; b < found.branches.size(); ++b) {
    Tree_branch branch;
    if (found.branches[b].parent != none)
      branch.parent = found.branches[b].parent;
    branch.order = found.branches[b].order;
    branch.id = b;
    bundle.branches.push_back(branch);
  }
  tree[boost::graph_bundle] = std::move(bundle);
}

namespace internal {

/// Writes one value per vertex to the map of a named parameter, if it is given. `value(k)` is the
/// value of node `k`; `Is_value` holds for the permitted value types of the map.
template <class Tag, template <class> class Is_value, class NamedParameters, class Vertex, class F>
void write_attribute(const NamedParameters& np,
                     Tag tag,
                     const std::vector<Vertex>& vertex,
                     const F& value)
{
  if constexpr (pcs::internal::is_given_v<NamedParameters, Tag>) {
    const auto map = CGAL::parameters::get_parameter(np, tag);
    using Map = std::decay_t<decltype(map)>;
    using Value = pcs::Map_value<Map>;
    constexpr bool is_map_ok = Is_value<Value>::value && is_map_for_v<Map, Vertex, Value>;
    static_assert(
        is_map_ok,
        "pcs::extract_tree_skeleton(): `node_branch_map` must store integers, and "
        "`node_radius_error_map` floating point numbers; both must be writable and accept "
        "a vertex of the result as key");
    if constexpr (is_map_ok)
      for (std::size_t k = 0; k < vertex.size(); ++k)
        put(map, vertex[k], static_cast<Value>(value(k)));
  }
}

} // namespace internal

/// Replaces the contents of a graph that is not a `Tree_skeleton`. Writes the attributes of the
/// nodes to the maps in the named parameters.
template <class NamedParameters, class Graph>
void write_graph(const Branch_tree& found,
                 const Scan_frame& frame,
                 const NamedParameters& np,
                 Graph& tree)
{
  const auto point_map = CGAL::parameters::get_parameter(np, pcs::internal_np::node_point_map);
  const auto radius_map = CGAL::parameters::get_parameter(np, pcs::internal_np::node_radius_map);
  using Point_map = std::decay_t<decltype(point_map)>;
  using Radius_map = std::decay_t<decltype(radius_map)>;
  using Vertex = typename boost::graph_traits<Graph>::vertex_descriptor;
  using P = pcs::Map_value<Point_map>;
  using R = pcs::Map_value<Radius_map>;
  constexpr bool are_maps_ok = is_point_or_vector_v<P> && is_map_for_v<Point_map, Vertex, P> &&
                               std::is_floating_point_v<R> && is_map_for_v<Radius_map, Vertex, R>;
  static_assert(are_maps_ok,
                "pcs::extract_tree_skeleton(): `node_point_map` and `node_radius_map` must be "
                "writable, accept a vertex of the result as key, and store points with x(), y(), "
                "z() and floating point numbers");
  if constexpr (are_maps_ok) {
    using FT = std::decay_t<decltype(std::declval<const P&>().x())>;
    pcs::internal::clear_graph(tree);
    std::vector<Vertex> vertex;
    vertex.reserve(found.nodes.size());
    for (std::size_t k = 0; k < found.nodes.size(); ++k)
      vertex.push_back(add_vertex(tree));
    for (std::size_t k = 0; k < found.nodes.size(); ++k) {
      const Branch_node& from = found.nodes[k];
      const Vec3 p = frame.to_input(from.point);
      put(point_map, vertex[k], P(FT(p.x()), FT(p.y()), FT(p.z())));
      put(radius_map, vertex[k], R(frame.unit * from.radius));
      if (from.parent != none)
        add_edge(vertex[from.parent], vertex[k], tree);
    }
    internal::write_attribute<pcs::internal_np::node_radius_error_map_t, std::is_floating_point>(
        np,
        pcs::internal_np::node_radius_error_map,
        vertex,
        [&](std::size_t k) { return frame.unit * found.nodes[k].radius_error; });
    internal::write_attribute<pcs::internal_np::node_branch_map_t, std::is_integral>(
        np,
        pcs::internal_np::node_branch_map,
        vertex,
        [&](std::size_t k) { return found.nodes[k].branch; });
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RESULT_WRITE_RESULT_H
