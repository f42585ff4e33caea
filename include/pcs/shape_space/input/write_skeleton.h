// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a tree of the space to a skeleton of the caller.

#ifndef PCS_SHAPE_SPACE_INPUT_WRITE_SKELETON_H
#define PCS_SHAPE_SPACE_INPUT_WRITE_SKELETON_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Tree_skeleton.h>
#include <pcs/core/parameters/result_graph.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/graph_traits.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Returns, for each branch, the positions at which its children begin, without duplicates: number
/// of a node plus the fraction of the next edge. Positions near a node are moved to it.
/// `attachment`: position of each branch on its parent.
inline std::vector<std::vector<double>>
attachments_of_children(const Orl_layout& layout,
                        const Orl_coordinates& x,
                        const std::vector<std::size_t>& order,
                        std::vector<double>& attachment)
{
  constexpr double at_node = 1e-9;
  std::vector<std::vector<double>> attachments(layout.branches.size());
  attachment.assign(layout.branches.size(), 0);
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const std::size_t parent = layout.branches[b].parent;
    if (parent == none || order[b] == none)
      continue;
    const auto last = static_cast<double>(layout.branches[parent].number_of_edges);
    attachment[b] = std::min(last, std::max(0.0, x.attachment[b]));
    if (std::abs(attachment[b] - std::round(attachment[b])) < at_node)
      attachment[b] = std::round(attachment[b]);
    attachments[parent].push_back(attachment[b]);
  }
  for (auto& of_parent : attachments) {
    std::sort(of_parent.begin(), of_parent.end());
    of_parent.erase(std::unique(of_parent.begin(), of_parent.end()), of_parent.end());
  }
  return attachments;
}

/// Returns the largest distance of two nodes that are in one place, as for trees that are read. [L]
inline double least_length(const Orl_geometry& geometry)
{
  Vec3 low = geometry.node[0], high = low;
  for (const Vec3& p : geometry.node) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return shortest_edge * (high - low).norm();
}

} // namespace internal

/*!
  Writes a tree of the space as a skeleton. An edge that supports a branch is divided there.

  A branch that is not longer than `least_length`, and its subtree, are left out: the tree lacks
  them. A node that is not farther than `least_length` from the previous node of its branch is
  joined with it. Only the first node of a branch, which has its base radius, is in the place of a
  node of the parent. With a negative `least_length`, all branches and nodes are written. [L]
*/
template <class Kernel>
void write_skeleton(const Orl_layout& layout,
                    const Orl_coordinates& x,
                    const Orl_geometry& geometry,
                    const Vec3& origin,
                    double least_length,
                    Tree_skeleton<Kernel>& result)
{
  using FT = typename Kernel::FT;
  Tree_skeleton<Kernel> tree;
  Tree_bundle& bundle = tree[boost::graph_bundle];
  std::vector<std::size_t> branch_of(layout.branches.size(), npos);
  const std::vector<std::size_t> order = orders_of_branches(layout, x, least_length);
  std::vector<double> attachment;
  const std::vector<std::vector<double>> attachments =
      internal::attachments_of_children(layout, x, order, attachment);
  std::vector<std::vector<std::size_t>> vertex_at(layout.branches.size());
  for (std::size_t b = 0; b < layout.branches.size(); ++b) {
    const Orl_layout::Branch& branch = layout.branches[b];
    if (order[b] == none)
      continue;
    const bool is_trunk = branch.parent == none;
    branch_of[b] = bundle.branches.size();
    bundle.branches.push_back(
        {is_trunk ? npos : branch_of[branch.parent], static_cast<int>(order[b]), b});
    std::size_t previous = npos;
    Vec3 place = Vec3::Zero(); // of the previous node
    bool is_first = true;
    if (!is_trunk) {
      const auto& of_parent = attachments[branch.parent];
      const auto k = std::lower_bound(of_parent.begin(), of_parent.end(), attachment[b]);
      previous = vertex_at[branch.parent][static_cast<std::size_t>(k - of_parent.begin())];
    }
    const auto add = [&](const Vec3& local, double radius) {
      if (!is_first && (local - place).norm() <= least_length)
        return;
      is_first = false;
      place = local;
      const Vec3 p = local + origin;
      Tree_node<Kernel> node;
      node.point = typename Kernel::Point_3(static_cast<FT>(p.x()),
                                            static_cast<FT>(p.y()),
                                            static_cast<FT>(p.z()));
      node.radius = node.major_radius = node.minor_radius = static_cast<FT>(radius);
      node.branch = branch_of[b];
      const std::size_t v = add_vertex(node, tree);
      if (previous != npos)
        add_edge(previous, v, tree);
      else
        bundle.root = v;
      previous = v;
    };
    auto next = attachments[b].begin();
    for (std::size_t j = 0; j <= branch.number_of_edges; ++j) {
      const std::size_t v = layout.first_node(b) + j;
      const auto position = static_cast<double>(j);
      // between the previous node and this one
      for (; next != attachments[b].end() && *next < position; ++next) {
        const double f = *next - (position - 1);
        add((1 - f) * geometry.node[v - 1] + f * geometry.node[v],
            (1 - f) * geometry.radius[v - 1] + f * geometry.radius[v]);
        vertex_at[b].push_back(previous);
      }
      add(geometry.node[v], geometry.radius[v]);
      for (; next != attachments[b].end() && *next == position; ++next)
        vertex_at[b].push_back(previous);
    }
  }
  result = std::move(tree);
}

/// Replaces a graph that is not a `Tree_skeleton` by the nodes and edges of one. Writes positions
/// and radii to the maps `node_point_map` and `node_radius_map`, and branches to `node_branch_map`
/// if it is given.
template <class Kernel, class NamedParameters, class Graph>
void write_graph(const Tree_skeleton<Kernel>& tree, const NamedParameters& np, Graph& result)
{
  namespace tags = pcs::internal_np;
  using pcs::internal::is_given_v;
  constexpr bool are_given = is_given_v<NamedParameters, tags::node_point_map_t> &&
                             is_given_v<NamedParameters, tags::node_radius_map_t>;
  static_assert(are_given,
                "pcs: a result graph that is not a pcs::Tree_skeleton needs the named parameters "
                "`node_point_map` and `node_radius_map`");
  if constexpr (are_given) {
    using Vertex = typename boost::graph_traits<Graph>::vertex_descriptor;
    const auto point_map = CGAL::parameters::get_parameter(np, tags::node_point_map);
    const auto radius_map = CGAL::parameters::get_parameter(np, tags::node_radius_map);
    using P = Map_value<std::decay_t<decltype(point_map)>>;
    using R = Map_value<std::decay_t<decltype(radius_map)>>;
    constexpr bool are_maps = is_writable_point_map_v<std::decay_t<decltype(point_map)>, Vertex> &&
                              std::is_floating_point_v<R> &&
                              is_map_for_v<std::decay_t<decltype(radius_map)>, Vertex, R>;
    static_assert(
        are_maps,
        "pcs: `node_point_map` and `node_radius_map` must be writable, accept a vertex of "
        "the result as key, and store points with x(), y(), z() and floating point "
        "numbers");
    if constexpr (are_maps) {
      using FT = std::decay_t<decltype(std::declval<const P&>().x())>;
      pcs::internal::clear_graph(result);
      std::vector<Vertex> vertex;
      for (std::size_t v = 0; v < num_vertices(tree); ++v) {
        const auto& node = tree[v];
        vertex.push_back(add_vertex(result));
        put(point_map,
            vertex.back(),
            P(FT(node.point.x()), FT(node.point.y()), FT(node.point.z())));
        put(radius_map, vertex.back(), static_cast<R>(node.radius));
      }
      for (auto [e, end] = edges(tree); e != end; ++e)
        add_edge(vertex[source(*e, tree)], vertex[target(*e, tree)], result);
      if constexpr (is_given_v<NamedParameters, tags::node_branch_map_t>) {
        const auto map = CGAL::parameters::get_parameter(np, tags::node_branch_map);
        using B = Map_value<std::decay_t<decltype(map)>>;
        static_assert(std::is_integral_v<B> && is_map_for_v<std::decay_t<decltype(map)>, Vertex, B>,
                      "pcs: `node_branch_map` must be writable, accept a vertex of the result as "
                      "key, and store integers");
        for (std::size_t v = 0; v < vertex.size(); ++v)
          put(map, vertex[v], static_cast<B>(tree[v].branch));
      }
    }
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_WRITE_SKELETON_H
