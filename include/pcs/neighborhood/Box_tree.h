// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tree of tight boxes over consecutive points in spatial order.

#ifndef PCS_NEIGHBORHOOD_BOX_TREE_H
#define PCS_NEIGHBORHOOD_BOX_TREE_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace neighborhood {

/// A tight box around consecutive points. [L]
struct Tight_box
{
  Vec3 low, high;

  static Tight_box empty() { return {Vec3::Constant(1), Vec3::Constant(-1)}; }

  /// Returns the squared distance of `p` to the box. It is at most the squared distance to any
  /// point of the box, rounding included, if that is summed in the order x, y, z. [L^2]
  double squared_distance(const Vec3& p) const
  {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      const double d = std::max(std::max(low[c] - p[c], p[c] - high[c]), 0.0);
      sum += d * d;
    }
    return sum;
  }

  /// Whether two boxes have a common point. Without branches, which could not be predicted.
  bool overlaps(const Tight_box& other) const
  {
    return (is_ordered(low, other.high) & is_ordered(other.low, high)) != 0;
  }

  bool contains(const Vec3& p) const { return (is_ordered(low, p) & is_ordered(p, high)) != 0; }

  /// Returns 1 if no coordinate of `a` is larger than that of `b`, otherwise 0.
  static int is_ordered(const Vec3& a, const Vec3& b)
  {
    return int(a[0] <= b[0]) & int(a[1] <= b[1]) & int(a[2] <= b[2]);
  }

  /// Returns the box whose points have coordinates that differ by at most `distance`.
  Tight_box grown(double distance) const
  {
    return {(low.array() - distance).matrix(), (high.array() + distance).matrix()};
  }
};

/// The cells of the octree of `spatial_order()` with tight boxes, in the order of their first
/// points, parents first.
class Box_tree
{
public:
  struct Node
  {
    Tight_box box;
    std::uint32_t begin, end; ///< points
    std::uint32_t size;       ///< nodes of its subtree; 1 for leaves
  };

  /// The largest number of points of a group, whose neighbours are searched together. [count]
  static constexpr std::size_t largest_group = 32;

  /// Builds the tree of distinct points in the order of `spatial_order()`. Returns `false` if they
  /// are in another order. O(n log n).
  template <class ConcurrencyTag>
  bool build(const std::vector<Vec3>& points)
  {
    m_nodes.clear();
    m_groups.clear();
    std::atomic<bool> is_ordered{true};
    if (!points.empty())
      m_nodes = subtree<ConcurrencyTag>(points, 0, points.size(), is_ordered);
    for (std::size_t v = 0; v < m_nodes.size();) {
      const bool is_group = m_nodes[v].end - m_nodes[v].begin <= largest_group;
      if (is_group)
        m_groups.push_back(static_cast<std::uint32_t>(v));
      v += is_group ? m_nodes[v].size : 1;
    }
    return is_ordered;
  }

  const std::vector<Node>& nodes() const { return m_nodes; }
  /// Returns the largest nodes of at most `largest_group` points, in the order of their points.
  const std::vector<std::uint32_t>& groups() const { return m_groups; }

  /// Calls `visit(leaf)` for each leaf whose box overlaps `box`.
  template <class Visit>
  void visit_leaves(const Tight_box& box, const Visit& visit) const
  {
    const Node* node = m_nodes.data();
    for (const Node* end = node + m_nodes.size(); node < end;) {
      const bool is_near = node->box.overlaps(box);
      if (is_near && node->size == 1)
        visit(*node);
      node += is_near ? 1 : node->size;
    }
  }

private:
  /// Subtrees of at least this many points are built concurrently. [count]
  static constexpr std::size_t least_concurrent_size = 20000;

  template <class ConcurrencyTag>
  static std::vector<Node> subtree(const std::vector<Vec3>& points,
                                   std::size_t begin,
                                   std::size_t end,
                                   std::atomic<bool>& is_ordered)
  {
    std::vector<Node> nodes;
    if (end - begin < least_concurrent_size) {
      append(points, begin, end, is_ordered, nodes);
      return nodes;
    }
    nodes.push_back(make_node(points, begin, end));
    const Cuts cuts = find_cuts(points, nodes.front(), is_ordered);
    std::array<std::vector<Node>, 8> children;
    pcs::internal::for_each_index<ConcurrencyTag>(
        cuts.count - 1,
        [&](std::size_t c) {
          children[c] = subtree<ConcurrencyTag>(points, cuts.at[c], cuts.at[c + 1], is_ordered);
        },
        1);
    for (const auto& child : children)
      nodes.insert(nodes.end(), child.begin(), child.end());
    nodes.front().size = static_cast<std::uint32_t>(nodes.size());
    return nodes;
  }

  static void append(const std::vector<Vec3>& points,
                     std::size_t begin,
                     std::size_t end,
                     std::atomic<bool>& is_ordered,
                     std::vector<Node>& nodes)
  {
    const std::size_t v = nodes.size();
    nodes.push_back(make_node(points, begin, end));
    if (end - begin <= octree_leaf_size)
      return;
    const Cuts cuts = find_cuts(points, nodes[v], is_ordered);
    for (std::size_t c = 0; c + 1 < cuts.count; ++c)
      append(points, cuts.at[c], cuts.at[c + 1], is_ordered, nodes);
    nodes[v].size = static_cast<std::uint32_t>(nodes.size() - v);
  }

  static Node make_node(const std::vector<Vec3>& points, std::size_t begin, std::size_t end)
  {
    Tight_box box{points[begin], points[begin]};
    for (std::size_t i = begin + 1; i < end; ++i) {
      box.low = box.low.cwiseMin(points[i]);
      box.high = box.high.cwiseMax(points[i]);
    }
    return {box, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), 1};
  }

  /// The first points of the octants of a cell that have points, and the end of the cell.
  struct Cuts
  {
    std::array<std::size_t, 9> at;
    std::size_t count;
  };

  /// Divides a cell into its octants, or into halves if one octant has all points.
  static Cuts
  find_cuts(const std::vector<Vec3>& points, const Node& node, std::atomic<bool>& is_ordered)
  {
    const Octree_cell cell(node.box.low, node.box.high);
    Cuts cuts{{node.begin}, 1};
    int last = cell.octant(points[node.begin]);
    for (std::size_t i = node.begin + 1; i < node.end; ++i) {
      const int octant = cell.octant(points[i]);
      if (octant > last)
        cuts.at[cuts.count++] = i;
      else if (octant < last) {
        is_ordered = false;
        break;
      }
      last = octant;
    }
    if (cuts.count < 2)
      cuts.at[cuts.count++] = node.begin + (node.end - node.begin) / 2;
    cuts.at[cuts.count++] = node.end;
    return cuts;
  }

  std::vector<Node> m_nodes;
  std::vector<std::uint32_t> m_groups;
};

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_BOX_TREE_H
