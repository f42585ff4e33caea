// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeleton by cross-sections in dense regions and spanning trees in sparse ones [Aiteanu 2022].

#ifndef PCS_SKELETON_SLICES_SECTION_SKELETON_H
#define PCS_SKELETON_SLICES_SECTION_SKELETON_H

#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/model/Branch_grouper.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/slices/detect_sections.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options for building branches from sections.
struct Section_tree_options
{
  std::size_t neighbors = 12; ///< nearest sections to which a section may be joined [count]
  double longest = 25;        ///< largest length of a joint, in spacings [-]
  double turn_cost =
      1; ///< relative cost of a joint across the axes; 0: as published [Aiteanu 2022] [-]
  double wider = 1.5;  ///< largest ratio of the radius of a section to that of its parent [-]
  double thinning = 1; ///< least distance of nodes, in diameters [-]
  double dense_radius = 0.25,
         dense_offset = 2;   ///< largest distance of dense points, sum of radii and spacings [-]
  double allometry = 0.4;    ///< radius: this power of the length beyond; 1/2: da Vinci's rule [-]
  double twig_radius = 0.15; ///< radius of the thinnest twig, in spacings [-]
};

namespace internal {

class Section_tree_builder
{
public:
  Section_tree_builder(const Scan& scan,
                       const std::vector<std::uint8_t>& is_used,
                       const std::vector<Found_section>& sections,
                       const Section_tree_options& rules)
    : m_scan(scan), m_is_used(is_used), m_sections(sections), m_rules(rules)
  {
  }

  Branch_tree operator()(const std::vector<Index>& root)
  {
    m_node_of_point.assign(m_scan.size(), none);
    span(root);
    filter();
    thin();
    mark_dense();
    add_sparse(root);
    if (m_nodes.empty())
      return Branch_tree();
    Branch_grouper group(m_nodes, m_scan.spacing);
    Branch_tree tree = group();
    tree.node_of_point.assign(m_scan.size(), none);
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      if (m_node_of_point[i] != none)
        tree.node_of_point[i] = group.number()[m_node_of_point[i]];
    return tree;
  }

private:
  using Graph = boost::adjacency_list<boost::vecS,
                                      boost::vecS,
                                      boost::undirectedS,
                                      boost::no_property,
                                      boost::property<boost::edge_weight_t, double>>;

  /// Connects the centers by shortest paths from the section nearest to the root. Sets the parents
  /// of the sections and their order by path length.
  void span(const std::vector<Index>& root)
  {
    const std::size_t n = m_sections.size();
    m_parent.assign(n, none);
    m_order.clear();
    if (n == 0)
      return;
    std::vector<Vec3> centers;
    for (const Found_section& s : m_sections)
      centers.push_back(s.center);
    const neighborhood::Nearest_neighbors search(centers);
    Graph graph(n);
    std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
    for (Index i = 0; i < n; ++i) {
      search(centers[i], m_rules.neighbors + 1, found);
      for (const auto& f : found) {
        const Vec3 d = centers[f.index] - centers[i];
        const double length = d.norm();
        if (f.index == i || length > m_rules.longest * m_scan.spacing)
          continue;
        const double along = length > 0 ? std::min(std::abs(d.dot(m_sections[i].along)),
                                                   std::abs(d.dot(m_sections[f.index].along))) /
                                              length
                                        : 1;
        add_edge(i, f.index, length * (1 + m_rules.turn_cost * (1 - along)), graph);
      }
    }
    Vec3 foot = Vec3::Zero();
    for (const Index r : root)
      foot += m_scan.points[r];
    foot /= double(root.size());
    Index start = 0;
    for (Index i = 1; i < n; ++i)
      if ((centers[i] - foot).squaredNorm() < (centers[start] - foot).squaredNorm())
        start = i;
    std::vector<Index> predecessor(n);
    std::vector<double> distance(n);
    const auto index = get(boost::vertex_index, graph);
    boost::dijkstra_shortest_paths(
        graph,
        start,
        boost::predecessor_map(boost::make_iterator_property_map(predecessor.begin(), index))
            .distance_map(boost::make_iterator_property_map(distance.begin(), index)));
    for (Index i = 0; i < n; ++i)
      if (distance[i] < std::numeric_limits<double>::max())
        m_order.push_back(i);
    std::stable_sort(m_order.begin(), m_order.end(), [&](Index a, Index b) {
      return distance[a] < distance[b];
    });
    // the start is first, even if other distances are zero, too
    std::stable_partition(m_order.begin(), m_order.end(), [&](Index a) { return a == start; });
    for (const Index i : m_order)
      if (i != start)
        m_parent[i] = predecessor[i];
  }

  /// Removes sections that are much wider than their parents, and tips with the center inside the
  /// parent.
  void filter()
  {
    const std::size_t n = m_sections.size();
    m_is_alive.assign(n, 0);
    std::vector<std::size_t> children(n, 0);
    for (const Index i : m_order) {
      m_is_alive[i] = 1;
      const Index p = m_parent[i];
      if (p == none)
        continue;
      while (m_parent[i] != none && !m_is_alive[m_parent[i]])
        m_parent[i] = m_parent[m_parent[i]];
      if (m_parent[i] != none &&
          m_sections[i].radius() > m_rules.wider * m_sections[m_parent[i]].radius())
        m_is_alive[i] = 0;
    }
    for (const Index i : m_order)
      if (m_is_alive[i] && m_parent[i] != none)
        ++children[m_parent[i]];
    for (std::size_t k = m_order.size(); k-- > 0;) {
      const Index i = m_order[k], p = m_parent[i];
      if (!m_is_alive[i] || children[i] > 0 || p == none)
        continue;
      if ((m_sections[i].center - m_sections[p].center).norm() < m_sections[p].radius()) {
        m_is_alive[i] = 0;
        --children[p];
      }
    }
  }

  /// Makes nodes of the start, forks and tips, and of other sections that are at least `thinning`
  /// diameters from the last node towards the root.
  void thin()
  {
    const std::size_t n = m_sections.size();
    std::vector<std::size_t> children(n, 0);
    for (const Index i : m_order)
      if (m_is_alive[i] && m_parent[i] != none)
        ++children[m_parent[i]];
    std::vector<Index> number(n, none);
    m_nodes.clear();
    for (const Index i : m_order) {
      if (!m_is_alive[i])
        continue;
      const Found_section& s = m_sections[i];
      const Index p = m_parent[i];
      const Index before = p == none ? none : number[p];
      const bool is_needed = p == none || children[i] != 1 ||
                             (s.center - m_nodes[before].point).norm() >=
                                 m_rules.thinning * 2 * m_nodes[before].radius;
      if (!is_needed) {
        number[i] = before;
        continue;
      }
      Branch_node node;
      node.point = s.center;
      node.radius = s.radius();
      node.is_measured = true;
      node.major_radius = s.major;
      node.minor_radius = s.minor;
      node.major_axis = s.major_axis;
      node.parent = before;
      number[i] = static_cast<Index>(m_nodes.size());
      m_nodes.push_back(node);
    }
  }

  /// Marks the points near the generalized cylinder of an edge as dense, and assigns them to the
  /// child node of the edge.
  void mark_dense()
  {
    std::vector<Index> near;
    std::vector<double> best(m_scan.size(), std::numeric_limits<double>::infinity());
    for (Index v = 0; v < m_nodes.size(); ++v) {
      const Branch_node& node = m_nodes[v];
      const Branch_node& below = m_nodes[node.parent == none ? v : node.parent];
      const Vec3 d = node.point - below.point;
      const double wide = std::max(node.radius, below.radius);
      const double reach =
          (1 + m_rules.dense_radius) * wide + m_rules.dense_offset * m_scan.spacing;
      near.clear();
      m_scan.search->within(0.5 * (node.point + below.point),
                            std::hypot(0.5 * d.norm() + wide, reach),
                            near);
      for (const Index i : near) {
        if (!m_is_used[i])
          continue;
        const Vec3 q = m_scan.points[i] - below.point;
        const double l2 = d.squaredNorm();
        const double t = l2 > 0 ? std::min(1.0, std::max(0.0, q.dot(d) / l2)) : 1;
        const double radius = (1 - t) * below.radius + t * node.radius;
        const double off = std::abs((q - t * d).norm() - radius);
        if (off < m_rules.dense_radius * radius + m_rules.dense_offset * m_scan.spacing &&
            off < best[i]) {
          best[i] = off;
          m_node_of_point[i] = v;
        }
      }
    }
  }

  /// Spanning trees over sparse points: their level-set components, and the dense nodes to which
  /// the trees are attached.
  struct Sparse_trees
  {
    Layer_tree layers;
    std::vector<double> importance; ///< length of the edges from the parent of each node on [L]
    std::vector<Vec3> center;       ///< smoothed centers
    std::vector<Index> top;         ///< root of the spanning tree of each node
    std::vector<Index> joint;       ///< for each node in `top`: its dense parent node, or `none`
  };

  /// Adds spanning trees over the remaining points, contracted to level-set components. The radius
  /// of a node is the radius at the joint times a power (`allometry`) of the importance of the node
  /// relative to that of the root of its spanning tree.
  void add_sparse(const std::vector<Index>& root)
  {
    const std::size_t n = m_scan.size();
    std::vector<std::uint8_t> is_rest(n);
    for (std::size_t i = 0; i < n; ++i)
      is_rest[i] = m_is_used[i] && m_node_of_point[i] == none;
    const Links links = link_points();
    const Shortest_paths paths =
        shortest_paths(m_scan, graph_of(n, links), sources_of(is_rest, root));
    Sparse_trees trees;
    trees.layers = layers_of(is_rest, links, paths);
    measure_importance(trees);
    smooth(trees);
    find_joints(paths, trees);
    add_nodes(trees);
  }

  Links link_points() const
  {
    const Link_rule rule;
    Links links = neighbor_links<CGAL::Sequential_tag>(m_scan, m_is_used, rule);
    const Links gaps = links_across_gaps(m_scan,
                                         m_is_used,
                                         rule,
                                         connected_parts<CGAL::Sequential_tag>(m_is_used, links));
    links.insert(links.end(), gaps.begin(), gaps.end());
    return links;
  }

  /// Returns all dense points, so that every sparse subtree begins at the border of the dense
  /// region. Returns the root if there are no dense points.
  std::vector<Index> sources_of(const std::vector<std::uint8_t>& is_rest,
                                const std::vector<Index>& root) const
  {
    std::vector<Index> sources;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i] && !is_rest[i])
        sources.push_back(i);
    return sources.empty() ? root : sources;
  }

  /// Returns the level-set components of the remaining points, without the dense points.
  Layer_tree layers_of(const std::vector<std::uint8_t>& is_rest,
                       const Links& links,
                       const Shortest_paths& paths) const
  {
    Links inner;
    for (const Link& l : links)
      if (is_rest[l.first] && is_rest[l.second])
        inner.push_back(l);
    Shortest_paths rest = paths;
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      if (!is_rest[i])
        rest.distance[i] = std::numeric_limits<double>::infinity();
      else if (m_node_of_point[paths.predecessor[i]] != none)
        rest.predecessor[i] = static_cast<Index>(i);
    return layer_tree<CGAL::Sequential_tag>(m_scan, inner, rest);
  }

  void measure_importance(Sparse_trees& trees) const
  {
    const Layer_tree& tree = trees.layers;
    std::vector<double>& importance = trees.importance;
    importance.assign(tree.size(), 0);
    for (std::size_t v = tree.size(); v-- > 0;) {
      importance[v] +=
          tree.parent[v] == none ? 0 : (tree.center[v] - tree.center[tree.parent[v]]).norm();
      importance[v] += m_scan.spacing;
      if (tree.parent[v] != none)
        importance[tree.parent[v]] += importance[v];
    }
  }

  /// Smooths the centers along the paths from the joints.
  static void smooth(Sparse_trees& trees)
  {
    const Layer_tree& tree = trees.layers;
    std::vector<Vec3>& center = trees.center;
    center = tree.center;
    for (Index v = 0; v < tree.size(); ++v)
      if (tree.parent[v] != none)
        center[v] = 0.5 * tree.center[v] + 0.5 * (0.5 * (center[tree.parent[v]] + tree.center[v]));
  }

  void find_joints(const Shortest_paths& paths, Sparse_trees& trees) const
  {
    const Layer_tree& tree = trees.layers;
    trees.top.resize(tree.size());
    trees.joint.assign(tree.size(), none);
    for (Index v = 0; v < tree.size(); ++v) {
      if (tree.parent[v] != none) {
        trees.top[v] = trees.top[tree.parent[v]];
        continue;
      }
      trees.top[v] = v;
      for (Index k = tree.first[v]; k < tree.first[v + 1] && trees.joint[v] == none; ++k)
        trees.joint[v] = m_node_of_point[paths.predecessor[tree.point[k]]];
    }
  }

  /// Adds nodes for the level-set components that are reachable.
  void add_nodes(const Sparse_trees& trees)
  {
    const Layer_tree& tree = trees.layers;
    std::vector<Index> number(tree.size(), none);
    for (Index v = 0; v < tree.size(); ++v) {
      const Index top = trees.top[v], at = trees.joint[top];
      if (at == none && !m_nodes.empty() && number[top] == none && top != v)
        continue; // unreachable
      if (at == none && top == v && !m_nodes.empty())
        continue;
      const double base = at == none ? m_scan.spacing : m_nodes[at].radius;
      const double importance = trees.importance[v] / trees.importance[top];
      Branch_node node;
      node.point = trees.center[v];
      node.radius = std::max(m_rules.twig_radius * m_scan.spacing,
                             std::min(base, base * std::pow(importance, m_rules.allometry)));
      node.parent = tree.parent[v] == none ? at : number[tree.parent[v]];
      number[v] = static_cast<Index>(m_nodes.size());
      m_nodes.push_back(node);
      for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
        m_node_of_point[tree.point[k]] = number[v];
    }
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const std::vector<Found_section>& m_sections;
  Section_tree_options m_rules;
  std::vector<Index> m_parent, m_order, m_node_of_point;
  std::vector<std::uint8_t> m_is_alive;
  std::vector<Branch_node> m_nodes;
};

} // namespace internal

/// Builds the tree of branches from sections, as published [Aiteanu 2022].
inline Branch_tree section_skeleton(const Scan& scan,
                                    const std::vector<std::uint8_t>& is_used,
                                    const std::vector<Found_section>& sections,
                                    const std::vector<Index>& root,
                                    const Section_tree_options& rules)
{
  return internal::Section_tree_builder(scan, is_used, sections, rules)(root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_SECTION_SKELETON_H
