// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// From the caller's graphs and ranges to arrays, and back.

#ifndef PCS_SHAPE_SPACE_TREE_INPUT_H
#define PCS_SHAPE_SPACE_TREE_INPUT_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Orl_correspondences.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/errors.h>
#include <pcs/shape_space/Common_topology.h>
#include <pcs/shape_space/Orl_coordinates.h>
#include <pcs/shape_space/Rooted_tree.h>
#include <pcs/shape_space/assign_points.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>

#include <boost/graph/graph_concepts.hpp>

#include <algorithm>
#include <array>
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

/// A tree and its scan, both relative to the root of the tree.
struct Tree_input
{
  Rooted_tree tree;
  std::vector<Vec3> points;
  std::vector<Vec3> normals; ///< of unit length; empty: none
  std::uint64_t fingerprint = 0;
};

namespace internal {

template <class Graph>
struct Is_tree_skeleton : std::false_type
{
};
template <class Kernel>
struct Is_tree_skeleton<boost::adjacency_list<boost::vecS,
                                              boost::vecS,
                                              boost::bidirectionalS,
                                              Tree_node<Kernel>,
                                              boost::no_property,
                                              Tree_bundle>> : std::true_type
{
};

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
  // CGAL::to_double() takes everything and returns a tag for what is no number
  : std::is_convertible<decltype(CGAL::to_double(
                            get(std::declval<const Map&>(), std::declval<Key>()))),
                        double>
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
                // after these two: it is an error, not a "no", for what is no graph at all
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

} // namespace internal

/// Copies and checks what the caller gives.
template <class Kernel, class TreeGraph, class PointRange, class NamedParameters>
Tree_input make_tree_input(const TreeGraph& graph,
                           const PointRange& scan,
                           const NamedParameters& np,
                           const std::string& caller)
{
  namespace tags = pcs::internal_np;
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
  constexpr bool has_maps = has_own_maps || internal::Is_tree_skeleton<TreeGraph>::value;
  static_assert(
      has_maps,
      "pcs: a tree that is no pcs::Tree_skeleton needs the named parameters `node_point_map` and "
      "`node_radius_map`");
  if constexpr (is_graph && is_range && has_maps) {
    using Vertex = typename boost::graph_traits<TreeGraph>::vertex_descriptor;
    const auto node_maps = [&] {
      if constexpr (has_own_maps)
        return std::make_pair(CGAL::parameters::get_parameter(np, tags::node_point_map),
                              CGAL::parameters::get_parameter(np, tags::node_radius_map));
      else {
        using Node = typename TreeGraph::vertex_bundled;
        return std::make_pair(get(&Node::point, graph), get(&Node::radius, graph));
      }
    }();
    const auto index_map = [&] {
      if constexpr (pcs::internal::is_given_v<NamedParameters, tags::node_index_map_t>)
        return CGAL::parameters::get_parameter(np, tags::node_index_map);
      else
        return get(boost::vertex_index, graph);
    }();
    using Element = Element_reference<const PointRange>;
    const auto point_map =
        pcs::internal::choose(np,
                              CGAL::internal_np::point_map,
                              CGAL::Identity_property_map<std::decay_t<Element>>());
    constexpr bool are_node_points =
        internal::Is_point_valued<std::decay_t<decltype(node_maps.first)>, Vertex>::value;
    static_assert(are_node_points,
                  "pcs: `node_point_map` must be a readable property map from vertices to points "
                  "with x(), y(), z()");
    constexpr bool are_node_radii =
        internal::Is_number_valued<std::decay_t<decltype(node_maps.second)>, Vertex>::value;
    static_assert(
        are_node_radii,
        "pcs: `node_radius_map` must be a readable property map from vertices to numbers");
    constexpr bool are_points =
        internal::Is_point_valued<std::decay_t<decltype(point_map)>, Element>::value;
    static_assert(are_points,
                  "pcs: `point_map` must be a readable property map from the elements of a scan to "
                  "points with x(), y(), z()");
    if constexpr (are_node_points && are_node_radii && are_points) {
      BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<TreeGraph>));
      BOOST_CONCEPT_ASSERT((boost::IncidenceGraphConcept<TreeGraph>));
      result.tree = make_rooted_tree(graph, node_maps.first, node_maps.second, index_map, caller);
      const auto n = static_cast<std::size_t>(std::end(scan) - std::begin(scan));
      if (n >= Orl_correspondences::no_point)
        throw Invalid_input(caller + ": a scan has " + std::to_string(n) +
                            " points, at most 4294967294 are supported");
      constexpr bool has_normals =
          pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
      std::uint64_t hash = 0xcbf29ce484222325u;
      for (std::size_t v = 0; v < result.tree.size(); ++v) {
        for (int i = 0; i < 3; ++i)
          internal::mix(hash, result.tree.points[v][i]);
        internal::mix(hash, result.tree.radii[v]);
      }
      for (std::size_t i = 0; i < n; ++i) {
        auto&& element = *(std::begin(scan) + static_cast<std::ptrdiff_t>(i));
        const Vec3 p = internal::to_vector(get(point_map, element)) - result.tree.origin;
        if (!p.allFinite())
          throw Invalid_input(caller + ": the coordinates of point " + std::to_string(i) +
                              " are not finite");
        result.points.push_back(p);
        for (int k = 0; k < 3; ++k)
          internal::mix(hash, p[k]);
        if constexpr (has_normals) {
          const Vec3 normal = internal::to_vector(
              get(CGAL::parameters::get_parameter(np, CGAL::internal_np::normal_map), element));
          const double length = normal.norm();
          if (!(length > 0) || !std::isfinite(length))
            throw Invalid_input(caller + ": the normal of point " + std::to_string(i) +
                                " is null or not finite");
          result.normals.push_back(normal / length);
        }
      }
      result.fingerprint = hash;
    }
  }
  return result;
}

/// The edges of the common topology that a tree has, as pieces of surface.
inline std::vector<Tube> make_tubes(const Orl_layout& layout,
                                    const Common_topology& topology,
                                    const Orl_geometry& geometry,
                                    std::size_t tree,
                                    const Vec3& shift,
                                    std::vector<std::size_t>& edge_of_tube)
{
  std::vector<Tube> tubes;
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; !topology.branches[b].is_virtual(static_cast<int>(tree)) &&
                            j < layout.branches[b].number_of_edges;
         ++j) {
      const std::size_t v = layout.first_node(b) + j;
      tubes.push_back({geometry.node[v] + shift,
                       geometry.node[v + 1] + shift,
                       geometry.radius[v],
                       geometry.radius[v + 1],
                       b});
      edge_of_tube.push_back(layout.branches[b].first_edge + j);
    }
  return tubes;
}

/// Edges whose radius is known at both ends in each tree that has them: there, detail is stored in units of the radius.
inline std::vector<char> edges_with_radius(const Orl_layout& layout,
                                           const Common_topology& topology,
                                           const std::array<Orl_geometry, 2>& geometry)
{
  std::vector<char> result(layout.number_of_edges(), 1);
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
      for (std::size_t t = 0; t < 2; ++t) {
        const std::size_t v = layout.first_node(b) + j;
        const double least = std::min(geometry[t].radius[v], geometry[t].radius[v + 1]);
        const double most = std::max(geometry[t].radius[v], geometry[t].radius[v + 1]);
        if (!topology.branches[b].is_virtual(static_cast<int>(t)) && !(least > 1e-3 * most))
          result[layout.branches[b].first_edge + j] = 0;
      }
  return result;
}

/// What is needed to find the same topology again.
inline Orl_correspondences store_topology(const Common_topology& topology,
                                          const std::array<const Tree_input*, 2>& inputs,
                                          const std::vector<Orl_correspondences::Pair>& pairs)
{
  Orl_correspondences result;
  for (std::size_t t = 0; t < 2; ++t)
    result.fingerprint[t] = inputs[t]->fingerprint;
  for (const Common_branch& b : topology.branches) {
    Orl_correspondences::Branch branch;
    branch.parent = b.parent;
    branch.nodes = b.node;
    branch.attachment = b.attachment;
    for (std::size_t t = 0; t < 2; ++t)
      if (b.path[t] != none) {
        const Branch_path& path = topology.paths[t].paths[b.path[t]];
        branch.first[t] = path.nodes[path.is_trunk ? 0 : 1];
        branch.tip[t] = path.tip();
      }
    result.branches.push_back(std::move(branch));
  }
  result.pairs = pairs;
  return result;
}

/// Checks everything: correspondences may come from a file.
inline Common_topology restore_topology(const Orl_correspondences& stored,
                                        const std::array<const Tree_input*, 2>& inputs,
                                        const std::string& caller)
{
  const auto check = [&](bool is_right, const char* what) {
    if (!is_right)
      throw Invalid_input(caller + ": " + what);
  };
  for (std::size_t t = 0; t < 2; ++t)
    check(stored.fingerprint[t] == inputs[t]->fingerprint,
          "the correspondences were computed for other trees");
  check(!stored.branches.empty(), "there are no branches");
  Common_topology result;
  for (std::size_t i = 0; i < stored.branches.size(); ++i) {
    const Orl_correspondences::Branch& b = stored.branches[i];
    Common_branch branch;
    check(i == 0 ? b.parent == none : b.parent < i, "a branch comes before its parent");
    branch.parent = b.parent;
    branch.node = b.nodes;
    branch.attachment = b.attachment;
    for (std::size_t t = 0; t < 2; ++t) {
      const Rooted_tree& tree = inputs[t]->tree;
      if (b.tip[t] == none) {
        check(b.nodes[t].empty() && i > 0, "a branch that a tree lacks has nodes there");
        continue;
      }
      check(b.tip[t] < tree.size() && b.first[t] < tree.size(), "there is no such node");
      std::vector<std::size_t> nodes{b.tip[t]};
      while (nodes.back() != b.first[t] && tree.parents[nodes.back()] != none)
        nodes.push_back(tree.parents[nodes.back()]);
      check(nodes.back() == b.first[t], "a branch does not lead to its tip");
      if (b.first[t] != 0)
        nodes.push_back(tree.parents[b.first[t]]);
      std::reverse(nodes.begin(), nodes.end());
      check(nodes.size() > 1, "a branch has no edge");
      check((b.first[t] == 0) == (i == 0), "a branch begins with the root");
      branch.path[t] = result.paths[t].paths.size();
      result.paths[t].paths.push_back(internal::make_path(tree, std::move(nodes), b.first[t] == 0));
      const std::vector<double>& s = b.nodes[t];
      check(s.size() > 1 && s.front() == 0 && s.back() == 1, "a branch does not go from 0 to 1");
      for (std::size_t k = 1; k < s.size(); ++k)
        check(s[k] > s[k - 1], "the nodes of a branch do not increase");
    }
    check(branch.path[0] != none || branch.path[1] != none, "a branch is in neither tree");
    check(b.nodes[0].empty() || b.nodes[1].empty() || b.nodes[0].size() == b.nodes[1].size(),
          "a branch has different numbers of nodes in the two trees");
    for (std::size_t t = 0; t < 2 && i > 0; ++t)
      check(b.attachment[t] >= 0 &&
                b.attachment[t] <=
                    static_cast<double>(result.branches[b.parent].number_of_nodes() - 1),
            "a branch is attached beyond its parent");
    result.branches.push_back(std::move(branch));
  }
  return result;
}

inline void check_pairs(const Orl_correspondences& stored,
                        std::size_t number_of_edges,
                        const std::array<std::size_t, 2>& number_of_points,
                        const std::string& caller)
{
  std::uint32_t last = 0;
  for (const Orl_correspondences::Pair& p : stored.pairs) {
    const bool has_points =
        p.point[0] != Orl_correspondences::no_point || p.point[1] != Orl_correspondences::no_point;
    bool is_right = p.edge >= last && p.edge < number_of_edges && has_points;
    for (std::size_t t = 0; t < 2; ++t)
      is_right = is_right &&
                 (p.point[t] == Orl_correspondences::no_point || p.point[t] < number_of_points[t]);
    if (!is_right)
      throw Invalid_input(caller +
                          ": a pair of points names what does not exist, or is out of order");
    last = p.edge;
  }
}

/// A tree of the space as a skeleton. Branches without length, and what hangs on them, are left out.
template <class Kernel>
void write_skeleton(const Orl_layout& layout,
                    const Orl_coordinates& x,
                    const Orl_geometry& geometry,
                    const Vec3& origin,
                    Tree_skeleton<Kernel>& result)
{
  using FT = typename Kernel::FT;
  Tree_skeleton<Kernel> tree;
  Tree_bundle& bundle = tree[boost::graph_bundle];
  std::vector<std::size_t> vertex(layout.number_of_nodes(), npos);
  std::vector<std::size_t> branch_of(layout.branches.size(), npos);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    double length = 0;
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      length += x.length[branch.first_edge + j];
    const bool is_trunk = branch.parent == none;
    if (!is_trunk && (!(length > 0) || branch_of[branch.parent] == npos))
      continue;
    branch_of[b] = bundle.branches.size();
    bundle.branches.push_back({is_trunk ? npos : branch_of[branch.parent],
                               is_trunk ? 0 : bundle.branches[branch_of[branch.parent]].order + 1,
                               b});
    std::size_t previous = npos;
    if (!is_trunk) {
      const auto last = static_cast<double>(layout.branches[branch.parent].number_of_edges);
      const double t = std::min(last, std::max(0.0, x.attachment[b]));
      previous = vertex[layout.first_node(branch.parent) + static_cast<std::size_t>(t)];
    }
    for (std::size_t j = 0; j <= branch.number_of_edges; ++j) {
      const std::size_t v = layout.first_node(b) + j;
      const Vec3 p = geometry.node[v] + origin;
      Tree_node<Kernel> node;
      node.point = typename Kernel::Point_3(static_cast<FT>(p.x()),
                                            static_cast<FT>(p.y()),
                                            static_cast<FT>(p.z()));
      node.radius = node.major_radius = node.minor_radius = static_cast<FT>(geometry.radius[v]);
      node.branch = branch_of[b];
      vertex[v] = add_vertex(node, tree);
      if (previous != npos)
        add_edge(previous, vertex[v], tree);
      else
        bundle.root = vertex[v];
      previous = vertex[v];
    }
  }
  result = std::move(tree);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_TREE_INPUT_H
