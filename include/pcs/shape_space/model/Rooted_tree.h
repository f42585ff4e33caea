// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A rooted tree of any Boost.Graph type as arrays: parents first, coincident nodes merged.

#ifndef PCS_SHAPE_SPACE_MODEL_ROOTED_TREE_H
#define PCS_SHAPE_SPACE_MODEL_ROOTED_TREE_H

#include <pcs/core/errors.h>

#include <CGAL/number_utils.h>

#include <boost/graph/graph_traits.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

using Vec3 = Eigen::Vector3d;

/// Index of no node and no branch.
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// Edges shorter than this fraction of the extent of the tree are contracted: they have no
/// direction. [-]
constexpr double shortest_edge = 1e-9;

/// Largest coordinate relative to the root, length or radius. Larger values are refused like
/// infinite ones, because sums of squares must stay finite far beyond the ends of a path. [L]
constexpr double most_length = 1e100;

inline bool is_length(double value)
{
  return value >= 0 && value <= most_length;
}
inline bool is_place(const Vec3& p)
{
  return is_length(p.cwiseAbs().maxCoeff()) && p.allFinite();
}

/// A tree as arrays. Parents come first; node 0 is the root.
struct Rooted_tree
{
  Vec3 origin = Vec3::Zero();       ///< of the local coordinates, in those of the caller [L]
  double extent = 0;                ///< diagonal of the bounding box [L]
  std::vector<Vec3> points;         ///< relative to `origin` [L]
  std::vector<double> radii;        ///< [L]
  std::vector<double> base_radii;   ///< at the beginning of the edge to a node; NaN: unknown [L]
  std::vector<std::size_t> parents; ///< `none` for the root
  std::vector<std::size_t>
      sources; ///< index of the vertex in the caller's graph; `none` for a node put on an axis
  std::vector<std::size_t> first_child,
      children;                ///< children of v: [first_child[v], first_child[v + 1])
  std::vector<double> heights; ///< length of the longest path from a node to a tip [L]
  std::vector<double> weights; ///< length of all edges below a node [L]
  std::vector<std::size_t> node_of_source;

  std::size_t size() const { return points.size(); }
  double edge_length(std::size_t v) const { return (points[v] - points[parents[v]]).norm(); }
};

namespace internal {

/// Compares two siblings in a total order that depends neither on node numbers nor on rounding, and
/// on the pose of the tree only where branches are rotated copies of each other.
inline bool is_before(const Rooted_tree& tree, std::size_t v, std::size_t w)
{
  const double step = 1e-9 * tree.extent; // lengths that differ by less are the same
  const auto key = [&](std::size_t x) {
    const double length = tree.edge_length(x);
    return std::array<double, 4>{std::round((tree.heights[x] + length) / step),
                                 std::round((tree.weights[x] + length) / step),
                                 std::round(length / step),
                                 std::round(tree.radii[x] / step)};
  };
  const auto a = key(v), b = key(w);
  if (a != b)
    return a > b;
  for (int i = 0; i < 3; ++i)
    if (tree.points[v][i] != tree.points[w][i])
      return tree.points[v][i] < tree.points[w][i];
  if (tree.radii[v] != tree.radii[w])
    return tree.radii[v] > tree.radii[w];
  return v < w;
}

/// Computes children, heights and weights from parents; children are in the order of `is_before()`.
inline void connect(Rooted_tree& tree)
{
  const std::size_t n = tree.size();
  tree.heights.assign(n, 0);
  tree.weights.assign(n, 0);
  tree.first_child.assign(n + 1, 0);
  for (std::size_t v = 1; v < n; ++v)
    ++tree.first_child[tree.parents[v] + 1];
  std::partial_sum(tree.first_child.begin(), tree.first_child.end(), tree.first_child.begin());
  tree.children.resize(n > 0 ? n - 1 : 0);
  std::vector<std::size_t> next(tree.first_child.begin(), tree.first_child.end());
  for (std::size_t v = 1; v < n; ++v)
    tree.children[next[tree.parents[v]]++] = v;
  for (std::size_t v = n; v-- > 0;) {
    // sorted first, so that the sum of weights has one order, too
    std::sort(tree.children.begin() + static_cast<std::ptrdiff_t>(tree.first_child[v]),
              tree.children.begin() + static_cast<std::ptrdiff_t>(tree.first_child[v + 1]),
              [&](std::size_t a, std::size_t b) { return is_before(tree, a, b); });
    for (std::size_t c = tree.first_child[v]; c < tree.first_child[v + 1]; ++c) {
      const std::size_t w = tree.children[c];
      const double length = tree.edge_length(w);
      tree.heights[v] = std::max(tree.heights[v], length + tree.heights[w]);
      tree.weights[v] += length + tree.weights[w];
    }
  }
}

/// Returns the level of the branch of each node, 0 for the trunk, if every branch follows the
/// longest path. [count]
inline std::vector<std::size_t> levels_of_branches(const Rooted_tree& tree)
{
  std::vector<std::size_t> level(tree.size(), 0);
  for (std::size_t v = 0; v < tree.size(); ++v) // parents first
    for (std::size_t c = tree.first_child[v]; c < tree.first_child[v + 1]; ++c)
      level[tree.children[c]] = level[v] + (c == tree.first_child[v] ? 0 : 1);
  return level;
}

/// Largest distance of the first node of a branch from an axis on which the branch begins, as a
/// fraction of the radius there. [-]
constexpr double on_axis = 1e-3;

/*!
  Finds, for each child of `p`, the longest sibling whose edge passes through the child, or `none`.
  Among equal lengths, the first is taken. Siblings are searched by the x coordinates of their
  directions: O(n log n) for `n` children in all directions.
*/
inline std::vector<std::size_t>
axes_through(const Rooted_tree& tree, std::size_t p, const std::vector<std::size_t>& children)
{
  const std::size_t n = children.size();
  std::vector<std::size_t> result(n, none);
  const double shortest = shortest_edge * tree.extent;
  std::vector<Vec3> edge(n);
  std::vector<double> length(n);
  std::vector<std::pair<double, std::size_t>> by_x; // x of the direction, and the child
  double thickest = tree.radii[p];
  for (std::size_t i = 0; i < n; ++i) {
    edge[i] = tree.points[children[i]] - tree.points[p];
    length[i] = edge[i].norm();
    thickest = std::max(thickest, tree.radii[children[i]]);
    if (length[i] > shortest)
      by_x.emplace_back(edge[i].x() / length[i], i);
  }
  std::sort(by_x.begin(), by_x.end());
  std::vector<std::size_t> near;
  for (const auto& [x, i] : by_x) {
    // bound for the distance of the unit vectors if the end of edge i is on edge j
    const double apart = 1e-9 + 1.5 * std::max(on_axis * thickest, shortest) / length[i];
    near.clear();
    for (auto other =
             std::lower_bound(by_x.begin(), by_x.end(), std::make_pair(x - apart, std::size_t(0)));
         other != by_x.end() && other->first <= x + apart;
         ++other)
      near.push_back(other->second);
    std::sort(near.begin(), near.end());
    double longest = length[i] * (1 + shortest_edge);
    for (const std::size_t j : near) {
      const double t = edge[i].dot(edge[j]) / std::max(edge[j].squaredNorm(), 1e-300);
      const double radius = (1 - t) * tree.radii[p] + t * tree.radii[children[j]];
      if (j != i && length[j] > longest && t > 0 &&
          (edge[i] - t * edge[j]).norm() <= std::max(on_axis * radius, shortest)) {
        result[i] = j;
        longest = length[j];
      }
    }
  }
  return result;
}

/*!
  Adds nodes to axes at the bases of branches, where the first node of a branch lies on the axis of
  its parent between two nodes. Otherwise the branch would begin at the previous node and run along
  its parent.
*/
inline Rooted_tree with_nodes_at_bases(const Rooted_tree& all)
{
  const std::size_t n = all.size();
  std::vector<std::vector<std::size_t>> children(n);
  for (std::size_t v = 1; v < n; ++v)
    children[all.parents[v]].push_back(v);
  Rooted_tree tree;
  tree.origin = all.origin;
  tree.extent = all.extent;
  const auto add = [&](const Vec3& point, double radius, std::size_t parent, std::size_t source) {
    tree.points.push_back(point);
    tree.radii.push_back(radius);
    tree.parents.push_back(parent);
    tree.sources.push_back(source);
    return tree.size() - 1;
  };
  std::vector<std::size_t> new_node(n, none);
  new_node[0] = add(all.points[0], all.radii[0], none, all.sources[0]);
  struct Base
  {
    double share;
    std::size_t node;
  };
  for (std::size_t p = 0; p < n; ++p) {
    std::vector<std::vector<Base>> bases(children[p].size());
    const std::vector<std::size_t> axis_of = axes_through(all, p, children[p]);
    for (std::size_t i = 0; i < children[p].size(); ++i)
      if (axis_of[i] != none) {
        std::size_t axis = axis_of[i];
        while (axis_of[axis] != none) // this axis may itself lie on a longer one
          axis = axis_of[axis];
        const Vec3 w = all.points[children[p][axis]] - all.points[p];
        const double t = (all.points[children[p][i]] - all.points[p]).dot(w) / w.squaredNorm();
        bases[axis].push_back({t, children[p][i]});
      }
    for (std::size_t j = 0; j < children[p].size(); ++j)
      if (axis_of[j] == none) {
        std::size_t last = new_node[p];
        const std::size_t w = children[p][j];
        std::stable_sort(bases[j].begin(), bases[j].end(), [](const Base& a, const Base& b) {
          return a.share < b.share;
        });
        for (const Base& base : bases[j]) {
          const double radius = (1 - base.share) * all.radii[p] + base.share * all.radii[w];
          last = add(all.points[base.node], radius, last, none);
          new_node[base.node] =
              add(all.points[base.node], all.radii[base.node], last, all.sources[base.node]);
        }
        new_node[w] = add(all.points[w], all.radii[w], last, all.sources[w]);
      }
  }
  return tree;
}

/// Returns the tree without edges of length 0.
inline Rooted_tree without_coincident_nodes(const Rooted_tree& all, std::size_t number_of_sources)
{
  const double threshold = shortest_edge * all.extent;
  Rooted_tree tree;
  tree.origin = all.origin;
  tree.extent = all.extent;
  tree.node_of_source.resize(number_of_sources);
  std::vector<std::size_t> new_node(all.size());
  std::vector<double> base(all.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < all.size(); ++v) {
    const std::size_t p = all.parents[v];
    const bool is_joined =
        p != none && (all.points[v] - tree.points[new_node[p]]).norm() <= threshold;
    if (is_joined) {
      new_node[v] = new_node[p];
      // a duplicate node has no information on the radius at a base
      base[v] = all.radii[v] == all.radii[p] ? base[p] : all.radii[v];
    } else {
      new_node[v] = tree.size();
      tree.points.push_back(all.points[v]);
      tree.radii.push_back(all.radii[v]);
      tree.base_radii.push_back(p == none ? all.radii[v] : base[p]);
      tree.parents.push_back(p == none ? none : new_node[p]);
      tree.sources.push_back(all.sources[v]);
    }
    if (all.sources[v] == none)
      continue;
    tree.node_of_source[all.sources[v]] = new_node[v];
    if (tree.sources[new_node[v]] == none)
      tree.sources[new_node[v]] = all.sources[v];
  }
  connect(tree);
  return tree;
}

/// Copies a graph of the caller and checks that it is a rooted tree.
template <class TreeGraph, class NodePointMap, class RadiusMap, class VertexIndexMap>
class Graph_reader
{
public:
  Graph_reader(const TreeGraph& graph,
               const NodePointMap& point_map,
               const RadiusMap& radius_map,
               const VertexIndexMap& index_map,
               const std::string& caller)
    : m_graph(graph),
      m_point_map(point_map),
      m_radius_map(radius_map),
      m_index_map(index_map),
      m_caller(caller),
      m_size(static_cast<std::size_t>(num_vertices(graph)))
  {
  }

  /// Returns positions, radii, parents and sources of all nodes.
  Rooted_tree operator()()
  {
    if (m_size < 2)
      fail("the tree has " + std::to_string(m_size) + " nodes, at least 2 are needed");
    find_parents();
    copy_nodes(find_root());
    center();
    return std::move(m_tree);
  }

private:
  using Vertex = typename boost::graph_traits<TreeGraph>::vertex_descriptor;

  [[noreturn]] void fail(const std::string& what) const
  {
    throw Invalid_input(m_caller + ": " + what);
  }

  std::size_t index_of(const Vertex& v) const
  {
    const auto i = static_cast<std::size_t>(get(m_index_map, v));
    if (i >= m_size)
      fail("a vertex has the index " + std::to_string(i) + ", which is not below the " +
           std::to_string(m_size) + " nodes");
    return i;
  }

  void find_parents()
  {
    m_parents.assign(m_size, none);
    m_vertices.assign(m_size, *vertices(m_graph).first);
    std::vector<char> is_taken(m_size, 0);
    for (auto [v, end] = vertices(m_graph); v != end; ++v) {
      const std::size_t i = index_of(*v);
      if (is_taken[i])
        fail("two vertices have the index " + std::to_string(i));
      is_taken[i] = 1;
      m_vertices[i] = *v;
      for (auto [e, last] = out_edges(*v, m_graph); e != last; ++e) {
        const std::size_t c = index_of(target(*e, m_graph));
        if (m_parents[c] != none)
          fail("node " + std::to_string(c) + " has two parents, " + std::to_string(m_parents[c]) +
               " and " + std::to_string(i));
        m_parents[c] = i;
      }
    }
  }

  std::size_t find_root() const
  {
    const auto root = std::find(m_parents.begin(), m_parents.end(), none);
    if (root == m_parents.end())
      fail("the graph has no root: every node has a parent");
    const auto count = std::count(m_parents.begin(), m_parents.end(), none);
    if (count > 1)
      fail("the graph has " + std::to_string(count) + " nodes without parent; a tree has one root");
    return static_cast<std::size_t>(root - m_parents.begin());
  }

  /// Copies nodes breadth first along out-edges, so that parents come first.
  void copy_nodes(std::size_t root)
  {
    m_new_node.assign(m_size, none);
    add(root);
    for (std::size_t done = 0; done < m_tree.size(); ++done)
      for (auto [e, last] = out_edges(m_vertices[m_tree.sources[done]], m_graph); e != last; ++e)
        add(static_cast<std::size_t>(get(m_index_map, target(*e, m_graph))));
    if (m_tree.size() != m_size)
      fail(std::to_string(m_size - m_tree.size()) +
           " nodes are not reached from the root: there is a cycle");
  }

  void add(std::size_t i)
  {
    const auto& p = get(m_point_map, m_vertices[i]);
    const Vec3 position(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
    const double radius = CGAL::to_double(get(m_radius_map, m_vertices[i]));
    if (!position.allFinite())
      fail("the coordinates of node " + std::to_string(i) + " are not finite");
    if (!is_length(radius))
      fail("the radius of node " + std::to_string(i) + " is not a number from 0 to 1e100");
    m_new_node[i] = m_tree.size();
    m_tree.points.push_back(position);
    m_tree.radii.push_back(radius);
    m_tree.parents.push_back(m_parents[i] == none ? none : m_new_node[m_parents[i]]);
    m_tree.sources.push_back(i);
  }

  /// Moves the root to the origin.
  void center()
  {
    Vec3 low = m_tree.points[0], high = low;
    for (const Vec3& p : m_tree.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    m_tree.origin = m_tree.points[0];
    m_tree.extent = (high - low).norm();
    if (!(m_tree.extent > 0) || !is_length(m_tree.extent))
      fail("the nodes of the tree do not span a box of a size between 0 and 1e100");
    for (Vec3& p : m_tree.points)
      p -= m_tree.origin;
  }

  const TreeGraph& m_graph;
  const NodePointMap& m_point_map;
  const RadiusMap& m_radius_map;
  const VertexIndexMap& m_index_map;
  const std::string& m_caller;
  std::size_t m_size;
  std::vector<std::size_t> m_parents, m_new_node; // by index
  std::vector<Vertex> m_vertices;                 // by index
  Rooted_tree m_tree;
};

} // namespace internal

/*!
  Copies `graph`. The rules for the caller's data are checked here: one root, every other vertex has
  one parent and is reached from the root, coordinates and radii are finite and not beyond
  `most_length`, radii are not negative. Throws `pcs::Invalid_input` with a message that begins with
  `caller`.
*/
template <class TreeGraph, class NodePointMap, class RadiusMap, class VertexIndexMap>
Rooted_tree make_rooted_tree(const TreeGraph& graph,
                             const NodePointMap& point_map,
                             const RadiusMap& radius_map,
                             const VertexIndexMap& index_map,
                             const std::string& caller)
{
  const Rooted_tree all = internal::Graph_reader(graph, point_map, radius_map, index_map, caller)();
  return internal::without_coincident_nodes(internal::with_nodes_at_bases(all), all.size());
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_ROOTED_TREE_H
