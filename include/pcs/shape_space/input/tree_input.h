// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Copy of the caller's graphs and ranges to arrays, with all checks.

#ifndef PCS_SHAPE_SPACE_INPUT_TREE_INPUT_H
#define PCS_SHAPE_SPACE_INPUT_TREE_INPUT_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/shape_space/model/Rooted_tree.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>

#include <boost/graph/graph_concepts.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Trees with more levels are refused; real trees have about ten. [count]
constexpr std::size_t most_levels_of_branches = 250;

/// A tree and its scan, both relative to the root of the tree.
struct Tree_input
{
  Rooted_tree tree;
  std::vector<Vec3> points;
  std::vector<Vec3> normals;                                ///< of unit length; empty: none
  std::uint64_t fingerprint = 0, fingerprint_of_points = 0; ///< the latter is 0 without points
};

namespace internal {

template <class Map, class Key, class = void>
struct Is_point_valued : std::false_type
{
};
template <class Map, class Key>
struct Is_point_valued<
    Map,
    Key,
    std::void_t<decltype(get(std::declval<const Map&>(), std::declval<Key>()).x())>>
  : std::true_type
{
};

template <class Map, class Key, class = void>
struct Is_number_valued : std::false_type
{
};
template <class Map, class Key>
struct Is_number_valued<
    Map,
    Key,
    std::void_t<decltype(CGAL::to_double(get(std::declval<const Map&>(), std::declval<Key>())))>>
  // CGAL::to_double() accepts every type and returns a tag for types that are no numbers
  : std::is_convertible<decltype(CGAL::to_double(
                            get(std::declval<const Map&>(), std::declval<Key>()))),
                        double>
{
};

template <class Map, class Key, class = void>
struct Is_index_valued : std::false_type
{
};
template <class Map, class Key>
struct Is_index_valued<Map,
                       Key,
                       std::void_t<decltype(get(std::declval<const Map&>(), std::declval<Key>()))>>
  : std::is_integral<std::decay_t<decltype(get(std::declval<const Map&>(), std::declval<Key>()))>>
{
};

template <class Graph, class = void>
struct Is_listable_graph : std::false_type
{
};
template <class Graph>
struct Is_listable_graph<
    Graph,
    std::void_t<decltype(num_vertices(std::declval<const Graph&>())),
                decltype(vertices(std::declval<const Graph&>())),
                // only after these two, as it is an error instead of `false` for types that are no
                // graphs
                typename boost::graph_traits<Graph>::vertex_descriptor,
                decltype(out_edges(
                    std::declval<typename boost::graph_traits<Graph>::vertex_descriptor>(),
                    std::declval<const Graph&>()))>>
  : std::is_convertible<typename boost::graph_traits<Graph>::directed_category, boost::directed_tag>
{
};

template <class Range, class = void>
struct Has_resize : std::false_type
{
};
template <class Range>
struct Has_resize<Range, std::void_t<decltype(std::declval<Range&>().resize(std::size_t()))>>
  : std::true_type
{
};

template <class Range>
void resize_range(Range& range, std::size_t n, const char* caller)
{
  if constexpr (Has_resize<Range>::value)
    range.resize(n);
  else if (static_cast<std::size_t>(std::distance(std::begin(range), std::end(range))) < n)
    throw Invalid_input(std::string(caller) + ": the range has room for " +
                        std::to_string(std::distance(std::begin(range), std::end(range))) +
                        " points, " + std::to_string(n) + " are needed");
}

constexpr std::uint64_t hash_of_nothing = 0xcbf29ce484222325u;

inline void mix(std::uint64_t& hash, double value)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  for (int i = 0; i < 8; ++i) {
    hash ^= (bits >> (8 * i)) & 0xff;
    hash *= 0x100000001b3u;
  }
}

template <class Point>
Vec3 to_vector(const Point& p)
{
  return Vec3(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
}

/// Copies the graph, and checks the depth of its branches.
template <class TreeGraph, class PointMap, class RadiusMap, class IndexMap>
void read_tree(const TreeGraph& graph,
               const PointMap& point_map,
               const RadiusMap& radius_map,
               const IndexMap& index_map,
               const std::string& caller,
               Tree_input& result)
{
  result.tree = make_rooted_tree(graph, point_map, radius_map, index_map, caller);
  const std::vector<std::size_t> levels = levels_of_branches(result.tree);
  const std::size_t most = *std::max_element(levels.begin(), levels.end());
  if (most > most_levels_of_branches)
    throw Invalid_input(caller + ": the tree has " + std::to_string(most) +
                        " levels of branches; at most " + std::to_string(most_levels_of_branches) +
                        " are supported");
  result.fingerprint = hash_of_nothing;
  for (std::size_t v = 0; v < result.tree.size(); ++v) {
    for (int i = 0; i < 3; ++i)
      mix(result.fingerprint, result.tree.points[v][i]);
    mix(result.fingerprint, result.tree.radii[v]);
  }
}

/// Copies the points relative to the origin of the tree, and the normals if there are any.
template <class PointRange, class PointMap, class NamedParameters>
void read_scan(const PointRange& scan,
               const PointMap& point_map,
               const NamedParameters& np,
               const std::string& caller,
               Tree_input& result)
{
  constexpr bool has_normals =
      pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
  const auto n = static_cast<std::size_t>(std::end(scan) - std::begin(scan));
  if (n >= Orl_correspondences::no_point)
    throw Invalid_input(caller + ": a scan has " + std::to_string(n) +
                        " points, at most 4294967294 are supported");
  result.fingerprint_of_points = n > 0 ? hash_of_nothing : 0;
  for (std::size_t i = 0; i < n; ++i) {
    auto&& element = *(std::begin(scan) + static_cast<std::ptrdiff_t>(i));
    const Vec3 p = to_vector(get(point_map, element)) - result.tree.origin;
    if (!is_place(p))
      throw Invalid_input(caller + ": the coordinates of point " + std::to_string(i) +
                          " are not finite, or beyond 1e100");
    result.points.push_back(p);
    for (int k = 0; k < 3; ++k)
      mix(result.fingerprint_of_points, p[k]);
    if constexpr (has_normals) {
      const Vec3 normal = to_vector(
          get(CGAL::parameters::get_parameter(np, CGAL::internal_np::normal_map), element));
      const double length = normal.norm();
      if (!(length > 0) || !std::isfinite(length))
        throw Invalid_input(caller + ": the normal of point " + std::to_string(i) +
                            " is null or not finite");
      result.normals.push_back(normal / length);
    }
  }
}

/// Returns the maps of positions and radii: those of the caller, or the bundled properties of a
/// `Tree_skeleton`.
template <class TreeGraph, class NamedParameters>
auto node_maps(const TreeGraph& graph, const NamedParameters& np)
{
  namespace tags = pcs::internal_np;
  if constexpr (pcs::internal::is_given_v<NamedParameters, tags::node_point_map_t> &&
                pcs::internal::is_given_v<NamedParameters, tags::node_radius_map_t>)
    return std::make_pair(CGAL::parameters::get_parameter(np, tags::node_point_map),
                          CGAL::parameters::get_parameter(np, tags::node_radius_map));
  else {
    using Node = typename TreeGraph::vertex_bundled;
    return std::make_pair(get(&Node::point, graph), get(&Node::radius, graph));
  }
}

template <class TreeGraph, class NamedParameters>
auto node_index_map(const TreeGraph& graph, const NamedParameters& np)
{
  namespace tags = pcs::internal_np;
  if constexpr (pcs::internal::is_given_v<NamedParameters, tags::node_index_map_t>)
    return CGAL::parameters::get_parameter(np, tags::node_index_map);
  else
    return get(boost::vertex_index, graph);
}

/// Checks the property maps and copies the tree and its scan.
template <class TreeGraph, class PointRange, class NamedParameters>
void read_input(const TreeGraph& graph,
                const PointRange& scan,
                const NamedParameters& np,
                const std::string& caller,
                Tree_input& result)
{
  using Vertex = typename boost::graph_traits<TreeGraph>::vertex_descriptor;
  const auto maps = node_maps(graph, np);
  const auto index_map = node_index_map(graph, np);
  using Element = Element_reference<const PointRange>;
  const auto point_map =
      pcs::internal::choose(np,
                            CGAL::internal_np::point_map,
                            CGAL::Identity_property_map<std::decay_t<Element>>());
  constexpr bool are_node_points =
      Is_point_valued<std::decay_t<decltype(maps.first)>, Vertex>::value;
  static_assert(are_node_points,
                "pcs: `node_point_map` must be a readable property map from vertices to points "
                "with x(), y(), z()");
  constexpr bool are_node_radii =
      Is_number_valued<std::decay_t<decltype(maps.second)>, Vertex>::value;
  static_assert(are_node_radii,
                "pcs: `node_radius_map` must be a readable property map from vertices to numbers");
  constexpr bool are_points = Is_point_valued<std::decay_t<decltype(point_map)>, Element>::value;
  static_assert(are_points,
                "pcs: `point_map` must be a readable property map from the elements of a scan to "
                "points with x(), y(), z()");
  constexpr bool are_indices = Is_index_valued<std::decay_t<decltype(index_map)>, Vertex>::value;
  static_assert(are_indices,
                "pcs: `node_index_map` must be a readable property map from vertices to integers");
  using Normal_map =
      std::decay_t<decltype(pcs::internal::choose(np, CGAL::internal_np::normal_map, point_map))>;
  constexpr bool are_normals = Is_point_valued<Normal_map, Element>::value;
  static_assert(are_normals,
                "pcs: `normal_map` must be a readable property map from the elements of a scan to "
                "vectors with x(), y(), z()");
  if constexpr (are_node_points && are_node_radii && are_points && are_indices && are_normals) {
    BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<TreeGraph>));
    BOOST_CONCEPT_ASSERT((boost::IncidenceGraphConcept<TreeGraph>));
    read_tree(graph, maps.first, maps.second, index_map, caller, result);
    read_scan(scan, point_map, np, caller, result);
  }
}

} // namespace internal

/// Copies and checks a tree and its scan.
template <class Kernel, class TreeGraph, class PointRange, class NamedParameters>
Tree_input make_tree_input(const TreeGraph& graph,
                           const PointRange& scan,
                           const NamedParameters& np,
                           const std::string& caller)
{
  namespace tags = pcs::internal_np;
  pcs::internal::
      check_names<tags::node_point_map_t, tags::node_radius_map_t, tags::node_index_map_t>(np);
  Tree_input result;
  constexpr bool is_graph = internal::Is_listable_graph<TreeGraph>::value;
  static_assert(is_graph,
                "pcs: a tree must be a directed graph of Boost.Graph: a model of VertexListGraph "
                "and IncidenceGraph with "
                "edges from parent to child");
  constexpr bool is_range = is_random_access_range_v<const PointRange>;
  static_assert(is_range, "pcs: the points of a scan must be a random access range");
  constexpr bool has_own_maps =
      pcs::internal::is_given_v<NamedParameters, tags::node_point_map_t> &&
      pcs::internal::is_given_v<NamedParameters, tags::node_radius_map_t>;
  constexpr bool has_maps = has_own_maps || pcs::internal::Is_tree_skeleton<TreeGraph>::value;
  static_assert(
      has_maps,
      "pcs: a tree that is no pcs::Tree_skeleton needs the named parameters `node_point_map` and "
      "`node_radius_map`");
  if constexpr (is_graph && is_range && has_maps) {
    internal::read_input(graph, scan, np, caller, result);
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_TREE_INPUT_H
