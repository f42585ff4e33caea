// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branches of sparse regions: spanning trees of the points with allometric radii [Aiteanu 2022].

#ifndef PCS_SKELETON_SLICES_ADD_SPARSE_TREES_H
#define PCS_SKELETON_SLICES_ADD_SPARSE_TREES_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/slices/Cross_section_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Radius of the thinnest twig, in spacings [-].
constexpr double thinnest_twig = 0.15;

namespace internal {

template <class ConcurrencyTag>
class Sparse_tree_builder
{
public:
  Sparse_tree_builder(const Scan& scan,
                      const std::vector<std::uint8_t>& is_used,
                      double allometry,
                      std::vector<Branch_node>& nodes,
                      std::vector<Index>& node_of_point)
    : m_scan(scan),
      m_is_used(is_used),
      m_allometry(allometry),
      m_nodes(nodes),
      m_node_of_point(node_of_point)
  {
  }

  void operator()(const std::vector<Index>& root)
  {
    const std::size_t n = m_scan.size();
    std::vector<std::uint8_t> is_rest(n);
    for (std::size_t i = 0; i < n; ++i)
      is_rest[i] = m_is_used[i] && m_node_of_point[i] == none;
    const Links links = link_points();
    const Shortest_paths paths =
        shortest_paths(m_scan, graph_of(n, links), sources_of(is_rest, root));
    const Layer_tree tree = layers_of(is_rest, links, paths);
    measure_importance(tree);
    find_joints(paths, tree);
    take_sections(tree);
    m_sections.filter();
    const std::vector<Index> kept = m_sections.thin();
    smooth();
    add_nodes(tree, kept);
  }

private:
  Links link_points() const
  {
    const Link_rule rule;
    Links links = neighbor_links<ConcurrencyTag>(m_scan, m_is_used, rule);
    const Links gaps =
        links_across_gaps<ConcurrencyTag>(m_scan,
                                          m_is_used,
                                          rule,
                                          connected_parts<ConcurrencyTag>(m_is_used, links));
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

  /// Returns the level-set components of the remaining points.
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
    return layer_tree<ConcurrencyTag>(m_scan, inner, rest);
  }

  /// Sets the importance of each node: the length of the edges from its parent on.
  void measure_importance(const Layer_tree& tree)
  {
    std::vector<double>& importance = m_importance;
    importance.assign(tree.size(), 0);
    for (std::size_t v = tree.size(); v-- > 0;) {
      importance[v] +=
          tree.parent[v] == none ? 0 : (tree.center[v] - tree.center[tree.parent[v]]).norm();
      importance[v] += m_scan.spacing;
      if (tree.parent[v] != none)
        importance[tree.parent[v]] += importance[v];
    }
  }

  /// Finds the root of the spanning tree of each node, and the dense node to which a root is
  /// attached.
  void find_joints(const Shortest_paths& paths, const Layer_tree& tree)
  {
    m_top.resize(tree.size());
    m_joint.assign(tree.size(), none);
    for (Index v = 0; v < tree.size(); ++v) {
      if (tree.parent[v] != none) {
        m_top[v] = m_top[tree.parent[v]];
        continue;
      }
      m_top[v] = v;
      for (Index k = tree.first[v]; k < tree.first[v + 1] && m_joint[v] == none; ++k)
        m_joint[v] = m_node_of_point[paths.predecessor[tree.point[k]]];
    }
  }

  /// Sets the sections: the dense nodes, which are fixed, and the reachable sparse nodes. Their
  /// radius is the radius at the joint times a power of the importance of the node relative to that
  /// of the root of its spanning tree. Without dense nodes, the first spanning tree is the result.
  void take_sections(const Layer_tree& tree)
  {
    for (const Branch_node& node : m_nodes)
      add_section(node.point, node.radius, node.parent);
    const std::size_t m = m_sections.number_of_fixed = m_nodes.size();
    for (Index v = 0; v < tree.size(); ++v) {
      const Index top = m_top[v], joint = m_joint[top];
      const double base = joint == none ? m_scan.spacing : m_nodes[joint].radius;
      const double power = std::pow(m_importance[v] / m_importance[top], m_allometry);
      add_section(tree.center[v],
                  std::max(thinnest_twig * m_scan.spacing, std::min(base, base * power)),
                  tree.parent[v] == none ? joint : static_cast<Index>(m + tree.parent[v]));
      if (joint == none && (m > 0 || top != 0))
        m_sections.order.pop_back(); // unreachable
    }
  }

  void add_section(const Vec3& center, double radius, Index parent)
  {
    m_sections.order.push_back(static_cast<Index>(m_sections.parent.size()));
    m_sections.center.push_back(center);
    m_sections.radius.push_back(radius);
    m_sections.parent.push_back(parent);
  }

  /// Smooths the kept sparse centers, also at the joints. Tips keep their positions.
  void smooth()
  {
    Cross_section_tree& s = m_sections;
    std::vector<Index> next(s.parent.size(), none); // most important child
    const auto importance = [&](Index i) { return m_importance[i - s.number_of_fixed]; };
    for (const Index i : s.order)
      if (i >= s.number_of_fixed && s.is_kept[i] && s.parent[i] != none &&
          (next[s.parent[i]] == none || importance(i) > importance(next[s.parent[i]])))
        next[s.parent[i]] = i;
    const std::vector<Vec3> center = s.center;
    for (const Index i : s.order)
      if (i >= s.number_of_fixed && s.is_kept[i] && s.parent[i] != none && next[i] != none)
        s.center[i] = 0.5 * center[i] + 0.25 * (center[s.parent[i]] + center[next[i]]);
  }

  /// Adds nodes for the kept sections. The points of the others are assigned to the next kept node
  /// towards the root.
  void add_nodes(const Layer_tree& tree, const std::vector<Index>& kept)
  {
    const Cross_section_tree& s = m_sections;
    const std::size_t m = s.number_of_fixed;
    std::vector<Index> number(s.parent.size(), none);
    for (const Index i : s.order) {
      if (i < m) {
        number[i] = i;
        continue;
      }
      if (s.is_kept[i]) {
        Branch_node node;
        node.point = s.center[i];
        node.radius = s.radius[i];
        node.parent = s.parent[i] == none ? none : number[s.parent[i]];
        number[i] = static_cast<Index>(m_nodes.size());
        m_nodes.push_back(node);
      }
      const Index v = static_cast<Index>(i - m);
      for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
        m_node_of_point[tree.point[k]] = number[kept[i]];
    }
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  double m_allometry;
  std::vector<Branch_node>& m_nodes;
  std::vector<Index>& m_node_of_point;
  std::vector<double> m_importance;  ///< of the level-set components [L]
  std::vector<Index> m_top, m_joint; ///< root of the spanning tree; its dense parent, or `none`
  Cross_section_tree m_sections;
};

} // namespace internal

/// Adds branches for the used points without a node: spanning trees over their level-set
/// components, which are filtered, thinned and smoothed. Sets their nodes, parents first, and the
/// nodes of these points.
template <class ConcurrencyTag>
void add_sparse_trees(const Scan& scan,
                      const std::vector<std::uint8_t>& is_used,
                      const std::vector<Index>& root,
                      double allometry,
                      std::vector<Branch_node>& nodes,
                      std::vector<Index>& node_of_point)
{
  internal::Sparse_tree_builder<ConcurrencyTag>(scan, is_used, allometry, nodes, node_of_point)(
      root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_ADD_SPARSE_TREES_H
