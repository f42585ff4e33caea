// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Traits of the caller's points, graphs and named parameters; copy of a given skeleton.

#ifndef PCS_SKELETON_INPUT_CALLER_TYPES_H
#define PCS_SKELETON_INPUT_CALLER_TYPES_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/core/parameters/result_graph.h>
#include <pcs/skeleton/model/Given_skeleton.h>
#include <pcs/skeleton/model/Scan.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>

#include <boost/graph/graph_traits.hpp>
#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

template <class Point>
Vec3 to_vec3(const Point& p)
{
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

/// Reads the vertices of a graph, parents before their children. Throws `Invalid_input` unless the
/// graph is a single tree.
template <class Graph, class PointMap>
Given_skeleton read_given(const Graph& graph, const PointMap& point_map, const std::string& caller)
{
  using Vertex = typename boost::graph_traits<Graph>::vertex_descriptor;
  const auto check = [&](bool is_valid, const char* rule) {
    pcs::internal::check(is_valid, caller, std::string("given_skeleton ") + rule);
  };
  std::map<Vertex, Vertex> parent_of;
  std::size_t count = 0;
  for (auto [v, end] = vertices(graph); v != end; ++v, ++count)
    for (auto [e, last] = out_edges(*v, graph); e != last; ++e)
      check(parent_of.emplace(target(*e, graph), *v).second, "has a node with two parents");
  pcs::internal::check(count >= 2 && parent_of.size() + 1 == count,
                       caller,
                       "given_skeleton must be one tree with a root and at least one more node; "
                       "it has " +
                           std::to_string(count) + " nodes and " +
                           std::to_string(parent_of.size()) + " edges");
  Given_skeleton given;
  std::vector<Vertex> order;
  const auto add = [&](Vertex v, Index parent) {
    given.points.push_back(to_vec3(get(point_map, v)));
    check(given.points.back().allFinite(), "has a position that is not finite");
    given.parent.push_back(parent);
    order.push_back(v);
  };
  for (auto [v, end] = vertices(graph); v != end; ++v)
    if (parent_of.count(*v) == 0)
      add(*v, none);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Vertex v = order[k]; // `order` grows
    for (auto [e, last] = out_edges(v, graph); e != last; ++e)
      add(target(*e, graph), static_cast<Index>(k));
  }
  check(order.size() == count, "has a cycle");
  return given;
}

/// The types that follow from a point range and from named parameters.
template <class PointRange, class NamedParameters>
struct Skeleton_types
{
  using Element = pcs::Element_reference<const PointRange>;
  using Point_map = std::decay_t<decltype(pcs::internal::choose(
      std::declval<const NamedParameters&>(),
      CGAL::internal_np::point_map,
      std::declval<CGAL::Identity_property_map<std::decay_t<Element>>>()))>;
  using Point = pcs::Map_value<Point_map>;
};

template <class T, class = void>
struct Is_range_of_points : std::false_type
{
};
template <class T>
struct Is_range_of_points<
    T,
    std::enable_if_t<!std::is_void_v<typename pcs::internal::Iterator_of<T>::type>>>
  : pcs::internal::Is_coordinate_triple<std::decay_t<decltype(*std::begin(std::declval<T&>()))>>
{
};
template <class T>
constexpr bool is_range_of_points_v = Is_range_of_points<T>::value;

using pcs::internal::Is_mutable_graph;
using pcs::internal::is_tree_skeleton_v;

/// Whether `Map` takes branch indices: integers other than bool.
template <class Map, class Key>
constexpr bool is_index_map_v =
    std::is_integral_v<pcs::Map_value<Map>> && !std::is_same_v<pcs::Map_value<Map>, bool> &&
    is_map_for_v<Map, Key, std::size_t>;

/// Whether `Map` takes lengths: numbers other than integers.
template <class Map, class Key>
constexpr bool is_length_map_v =
    !std::is_integral_v<pcs::Map_value<Map>> && is_map_for_v<Map, Key, double>;

/// Whether `Map` takes vectors.
template <class Map, class Key>
constexpr bool is_vector_map_v =
    is_point_or_vector_v<pcs::Map_value<Map>>&& is_map_for_v<Map, Key, pcs::Map_value<Map>>;

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_INPUT_CALLER_TYPES_H
