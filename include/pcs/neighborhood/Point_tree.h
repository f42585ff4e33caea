// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A k-d tree that keeps the points of a leaf side by side.

#ifndef PCS_NEIGHBORHOOD_POINT_TREE_H
#define PCS_NEIGHBORHOOD_POINT_TREE_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/spatial_order.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace neighborhood {

/*!
  Cells are halved across the longest side of the tight box of their points, until few are left, or copies of one point.
  A query touches few cache lines, and points that come in spatial order hardly move while the tree is built. It is the same
  tree for every number of threads.
*/
class Point_tree
{
public:
  /// Copies `points`. O(n log n) unless distances differ by many orders of magnitude.
  template <class ConcurrencyTag>
  Point_tree(const std::vector<Vec3>& points, ConcurrencyTag) : m_entries(points.size())
  {
    pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
      m_entries[i] = {points[i], static_cast<std::uint32_t>(i)};
    });
    if (!points.empty())
      m_nodes = build<ConcurrencyTag>(0, points.size(), m_box);
  }

  std::size_t size() const { return m_entries.size(); }

  /*!
    Calls `collector.add(squared_distance, index)` for every point that is not farther than `collector.worst()`, a squared
    distance that may fall meanwhile; points of near cells first.
  */
  template <class Collector>
  void visit(const Vec3& query, Collector& collector) const
  {
    if (m_entries.empty())
      return;
    Vec3 apart = (m_box.low - query).cwiseMax(query - m_box.high).cwiseMax(0);
    apart = apart.cwiseProduct(apart);
    if (sum(apart) <= collector.worst())
      visit(0, query, apart, collector);
  }

private:
  struct Entry
  {
    Vec3 point;
    std::uint32_t index;
  };
  struct Box
  {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  };
  /// A cut; the first child is the next node. Or a leaf.
  struct Node
  {
    double low = 0, high = 0;   ///< where the first child ends and the second begins [L]
    std::uint32_t begin = 0;    ///< of the points of a leaf
    std::uint32_t behind = 0;   ///< distance of the second child; of a leaf, the end of its points
    Eigen::Index across = leaf; ///< the axis that is cut
  };
  static constexpr Eigen::Index leaf = -1;
  static constexpr std::size_t leaf_size = 10, task_size = 20000;

  /// In the order in which distances are added up: rounding then never makes a cell farther than its points.
  static double sum(const Vec3& squares) { return squares.x() + squares.y() + squares.z(); }

  /// The nodes of a cell, its own first.
  template <class ConcurrencyTag>
  std::vector<Node> build(std::size_t begin, std::size_t end, Box& box)
  {
    std::vector<Node> nodes;
    if (end - begin <= task_size) {
      append(begin, end, box, nodes);
      return nodes;
    }
    Node node;
    const std::size_t middle = cut(begin, end, box, node);
    if (node.across == leaf)
      return {node};
    Box first_box, second_box;
    std::vector<Node> second;
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] { nodes = build<ConcurrencyTag>(begin, middle, first_box); },
        [&] { second = build<ConcurrencyTag>(middle, end, second_box); });
    node.low = first_box.high[node.across];
    node.high = second_box.low[node.across];
    node.behind = static_cast<std::uint32_t>(nodes.size() + 1);
    nodes.insert(nodes.begin(), node);
    nodes.insert(nodes.end(), second.begin(), second.end());
    return nodes;
  }

  /// The same in one thread.
  void append(std::size_t begin, std::size_t end, Box& box, std::vector<Node>& nodes)
  {
    const std::size_t number = nodes.size();
    Node node;
    const std::size_t middle = cut(begin, end, box, node);
    nodes.push_back(node);
    if (node.across == leaf)
      return;
    Box child;
    append(begin, middle, child, nodes);
    node.low = child.high[node.across];
    node.behind = static_cast<std::uint32_t>(nodes.size() - number);
    append(middle, end, child, nodes);
    node.high = child.low[node.across];
    nodes[number] = node;
  }

  /// Finds the box of a cell, and parts its points unless they are a leaf. Returns where the second part begins.
  std::size_t cut(std::size_t begin, std::size_t end, Box& box, Node& node)
  {
    box.low = box.high = m_entries[begin].point;
    for (std::size_t i = begin + 1; i < end; ++i) {
      box.low = box.low.cwiseMin(m_entries[i].point);
      box.high = box.high.cwiseMax(m_entries[i].point);
    }
    Eigen::Index across = 0;
    const double side = (box.high - box.low).maxCoeff(&across);
    const double at = box.low[across] + 0.5 * side;
    if (end - begin <= leaf_size || !(at < box.high[across])) {
      node.begin = static_cast<std::uint32_t>(begin);
      node.behind = static_cast<std::uint32_t>(end);
      return end;
    }
    node.across = across;
    const auto entry = m_entries.begin();
    const auto middle = std::partition(entry + static_cast<std::ptrdiff_t>(begin),
                                       entry + static_cast<std::ptrdiff_t>(end),
                                       [&](const Entry& e) { return e.point[across] <= at; });
    return static_cast<std::size_t>(middle - entry);
  }

  /// `apart` holds the squared distances of the query from the cell along the axes.
  template <class Collector>
  void visit(std::size_t number, const Vec3& query, Vec3& apart, Collector& collector) const
  {
    const Node& node = m_nodes[number];
    if (node.across == leaf) {
      for (std::size_t i = node.begin; i < node.behind; ++i) {
        const Vec3 d = query - m_entries[i].point;
        const double squared_distance = sum(d.cwiseProduct(d));
        if (squared_distance <= collector.worst())
          collector.add(squared_distance, m_entries[i].index);
      }
      return;
    }
    const double from_first = query[node.across] - node.low,
                 from_second = node.high - query[node.across];
    const bool is_first_near = from_first < from_second;
    const std::size_t first = number + 1, second = number + node.behind;
    visit(is_first_near ? first : second, query, apart, collector);
    const double gap = std::max(0.0, is_first_near ? from_second : from_first);
    double& across = apart[node.across];
    const double before = across;
    across = std::max(before, gap * gap);
    if (sum(apart) <= collector.worst())
      visit(is_first_near ? second : first, query, apart, collector);
    across = before;
  }

  std::vector<Entry> m_entries;
  std::vector<Node> m_nodes;
  Box m_box;
};

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_POINT_TREE_H
