// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Skeleton by cross-sections in dense regions and spanning trees in sparse ones [Aiteanu 2022].

#ifndef PCS_SKELETON_SLICES_SECTION_SKELETON_H
#define PCS_SKELETON_SLICES_SECTION_SKELETON_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Branch_grouper.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/slices/Cross_section_tree.h>
#include <pcs/skeleton/slices/add_sparse_trees.h>
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

/// Number of nearest sections to which a section may be joined [count].
constexpr std::size_t neighbors_of_section = 12;
/// Largest length of a joint of sections, in spacings [-].
constexpr double longest_section_joint = 25;
/// Least length of a joint in its cost, in spacings [-].
constexpr double shortest_section_joint = 1e-6;

namespace internal {

template <class ConcurrencyTag>
class Section_tree_builder
{
public:
  Section_tree_builder(const Scan& scan,
                       const std::vector<std::uint8_t>& is_used,
                       const std::vector<Found_section>& sections,
                       const Slice_options& rules)
    : m_scan(scan), m_is_used(is_used), m_sections(sections), m_rules(rules)
  {
  }

  Branch_tree operator()(const std::vector<Index>& root)
  {
    m_node_of_point.assign(m_scan.size(), none);
    span(root);
    set_nodes();
    mark_dense();
    add_sparse_trees<ConcurrencyTag>(m_scan,
                                     m_is_used,
                                     root,
                                     m_rules.allometry,
                                     m_nodes,
                                     m_node_of_point);
    if (m_nodes.size() < 2) // no edge
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
    m_tree.parent.assign(n, none);
    m_tree.order.clear();
    if (n == 0)
      return;
    std::vector<Vec3> centers;
    for (const Found_section& s : m_sections)
      centers.push_back(s.center);
    const neighborhood::Nearest_neighbors search(centers);
    Graph graph(n);
    std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
    for (Index i = 0; i < n; ++i) {
      search(centers[i], neighbors_of_section + 1, found);
      for (const auto& f : found) {
        const Vec3 d = centers[f.index] - centers[i];
        const double length = d.norm();
        if (f.index == i || length > longest_section_joint * m_scan.spacing)
          continue;
        const double along = length > 0 ? std::min(std::abs(d.dot(m_sections[i].along)),
                                                   std::abs(d.dot(m_sections[f.index].along))) /
                                              length
                                        : 1;
        // coincident centers need a length, so that parents come before their children
        add_edge(i,
                 f.index,
                 std::max(length, shortest_section_joint * m_scan.spacing) *
                     (1 + m_rules.turn_cost * (1 - along)),
                 graph);
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
        m_tree.order.push_back(i);
    std::stable_sort(m_tree.order.begin(), m_tree.order.end(), [&](Index a, Index b) {
      return distance[a] < distance[b];
    });
    // the start is first, even if other distances are zero, too
    std::stable_partition(m_tree.order.begin(), m_tree.order.end(), [&](Index a) {
      return a == start;
    });
    for (const Index i : m_tree.order)
      if (i != start)
        m_tree.parent[i] = predecessor[i];
  }

  /// Sets the nodes: the sections that are no outliers, about one diameter apart.
  void set_nodes()
  {
    for (const Found_section& s : m_sections) {
      m_tree.center.push_back(s.center);
      m_tree.radius.push_back(s.radius());
    }
    m_tree.filter();
    m_tree.thin();
    std::vector<Index> number(m_sections.size(), none);
    for (const Index i : m_tree.order) {
      if (!m_tree.is_kept[i])
        continue;
      const Found_section& s = m_sections[i];
      Branch_node node;
      node.point = s.center;
      node.radius = s.radius();
      node.is_measured = true;
      node.major_radius = s.major;
      node.minor_radius = s.minor;
      node.major_axis = s.major_axis;
      node.parent = m_tree.parent[i] == none ? none : number[m_tree.parent[i]];
      number[i] = static_cast<Index>(m_nodes.size());
      m_nodes.push_back(node);
    }
  }

  /// Point near the surface of a generalized cylinder, and its distance.
  struct Near_point
  {
    Index point;
    double distance;
  };

  /// Marks the points near the generalized cylinder of an edge as dense, and assigns them to the
  /// child node of the nearest such edge.
  void mark_dense()
  {
    constexpr std::size_t batch = 1024, block = 16;
    std::vector<double> best(m_scan.size(), std::numeric_limits<double>::infinity());
    std::vector<std::vector<Near_point>> near(std::min(batch, m_nodes.size()));
    for (std::size_t first = 0; first < m_nodes.size(); first += batch) {
      const std::size_t count = std::min(batch, m_nodes.size() - first);
      pcs::internal::for_each_block<ConcurrencyTag>(
          count,
          block,
          [&](std::size_t begin, std::size_t end) {
            std::vector<Index> found;
            for (std::size_t k = begin; k < end; ++k)
              near[k] = points_near_edge(static_cast<Index>(first + k), found);
          });
      for (std::size_t k = 0; k < count; ++k)
        for (const Near_point& p : near[k])
          if (p.distance < best[p.point]) {
            best[p.point] = p.distance;
            m_node_of_point[p.point] = static_cast<Index>(first + k);
          }
    }
  }

  /// Returns the used points near the generalized cylinder of the edge to node `v`. `found` is a
  /// buffer.
  std::vector<Near_point> points_near_edge(Index v, std::vector<Index>& found) const
  {
    std::vector<Near_point> result;
    const Branch_node& node = m_nodes[v];
    const Branch_node& below = m_nodes[node.parent == none ? v : node.parent];
    const Vec3 d = node.point - below.point;
    const double wide = std::max(node.radius, below.radius);
    const double reach = (1 + m_rules.dense_radius) * wide + m_rules.dense_offset * m_scan.spacing;
    found.clear();
    m_scan.search->within(0.5 * (node.point + below.point),
                          std::hypot(0.5 * d.norm() + wide, reach),
                          found);
    for (const Index i : found) {
      if (!m_is_used[i])
        continue;
      const Vec3 q = m_scan.points[i] - below.point;
      const double l2 = d.squaredNorm();
      const double t = l2 > 0 ? std::min(1.0, std::max(0.0, q.dot(d) / l2)) : 1;
      const double radius = (1 - t) * below.radius + t * node.radius;
      const double off = std::abs((q - t * d).norm() - radius);
      if (off < m_rules.dense_radius * radius + m_rules.dense_offset * m_scan.spacing)
        result.push_back({i, off});
    }
    return result;
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const std::vector<Found_section>& m_sections;
  const Slice_options& m_rules;
  Cross_section_tree m_tree;
  std::vector<Index> m_node_of_point;
  std::vector<Branch_node> m_nodes;
};

} // namespace internal

/// Builds the tree of branches from sections, as published [Aiteanu 2022]. It is empty if there are
/// too few points for an edge.
template <class ConcurrencyTag>
Branch_tree section_skeleton(const Scan& scan,
                             const std::vector<std::uint8_t>& is_used,
                             const std::vector<Found_section>& sections,
                             const std::vector<Index>& root,
                             const Slice_options& rules)
{
  return internal::Section_tree_builder<ConcurrencyTag>(scan, is_used, sections, rules)(root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_SECTION_SKELETON_H
