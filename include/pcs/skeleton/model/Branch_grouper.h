// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Decomposition of a rooted tree of nodes into branches.

#ifndef PCS_SKELETON_MODEL_BRANCH_GROUPER_H
#define PCS_SKELETON_MODEL_BRANCH_GROUPER_H

#include <pcs/skeleton/model/Branch_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Decomposition of a tree of nodes into branches. Parents come before children, and the root is
/// first. `number()` has the new index of each node.
class Branch_grouper
{
public:
  Branch_grouper(std::vector<Branch_node> nodes, double spacing) : m_spacing(spacing)
  {
    m_tree.nodes = std::move(nodes);
  }

  Branch_tree operator()()
  {
    link();
    choose_continuations();
    number_branches();
    return std::move(m_tree);
  }

  const std::vector<Index>& number() const { return m_number; }

private:
  void link()
  {
    const std::size_t n = m_tree.nodes.size();
    m_child.assign(n, {});
    for (Index v = 0; v < n; ++v)
      if (m_tree.nodes[v].parent != none)
        m_child[m_tree.nodes[v].parent].push_back(v);
    m_carried.assign(n, 0);
    for (std::size_t v = n; v-- > 1;) {
      const Branch_node& node = m_tree.nodes[v];
      const double length = (node.point - m_tree.nodes[node.parent].point).norm();
      m_carried[node.parent] += m_carried[v] + node.radius * node.radius * length;
    }
  }

  /// Returns the node at `length` ahead of `v` towards the largest wood volume, or behind it.
  Index ahead(Index v, double length) const
  {
    double gone = 0;
    while (gone < length && !m_child[v].empty()) {
      Index best = m_child[v].front();
      for (const Index c : m_child[v])
        if (m_carried[c] > m_carried[best])
          best = c;
      gone += (m_tree.nodes[best].point - m_tree.nodes[v].point).norm();
      v = best;
    }
    return v;
  }
  Index behind(Index v, double length) const
  {
    double gone = 0;
    while (gone < length && m_tree.nodes[v].parent != none) {
      const Index p = m_tree.nodes[v].parent;
      gone += (m_tree.nodes[p].point - m_tree.nodes[v].point).norm();
      v = p;
    }
    return v;
  }

  /// Chooses the child that continues the branch at each fork by straightness and supported wood
  /// volume. Sums of volumes change little if a tip is missing.
  void choose_continuations()
  {
    const std::size_t n = m_tree.nodes.size();
    m_next.assign(n, none);
    const double unit = m_spacing * m_spacing * m_spacing;
    for (Index v = 0; v < n; ++v) {
      const Branch_node& node = m_tree.nodes[v];
      const double reach = 4 * node.radius + 8 * m_spacing;
      const Vec3 from = node.point - m_tree.nodes[behind(v, reach)].point;
      double best = 0;
      for (const Index c : m_child[v]) {
        const Index w = ahead(c, reach);
        const Vec3 to = m_tree.nodes[w].point - node.point;
        const double norm = from.norm() * to.norm();
        const double cosine = norm > 0 ? from.dot(to) / norm : 0;
        const double radius = 0.5 * (m_tree.nodes[c].radius + m_tree.nodes[w].radius);
        const double carried = m_carried[c] + 4 * m_spacing * radius * radius;
        const double score = straightness * cosine + std::log(carried / unit);
        if (m_next[v] == none || score > best) {
          best = score;
          m_next[v] = c;
        }
      }
    }
  }

  /// Traverses the continuations, inserts missing bases and drops coincident nodes.
  void number_branches()
  {
    std::vector<Branch_node> nodes;
    std::vector<Index> number(m_tree.nodes.size(), none);
    std::vector<std::pair<Index, Index>> stack{{0, none}}; // first node, index of its parent
    while (!stack.empty()) {
      const auto [start, seat] = stack.back();
      stack.pop_back();
      const Index b = static_cast<Index>(m_tree.branches.size());
      m_tree.branches.emplace_back();
      Branch& branch = m_tree.branches.back();
      if (seat != none) {
        branch.parent = nodes[seat].branch;
        branch.order = m_tree.branches[branch.parent].order + 1;
      }
      Index before = seat;
      const auto append = [&](Branch_node node) {
        node.parent = before;
        node.branch = b;
        before = static_cast<Index>(nodes.size());
        nodes.push_back(node);
        branch.nodes.push_back(before);
      };
      const double tiny = 1e-3 * m_spacing;
      if (seat != none && (m_tree.nodes[start].point - nodes[seat].point).norm() > tiny) {
        Branch_node base = m_tree.nodes[start];
        base.point = nodes[seat].point;
        base.is_measured = false;
        append(base);
      }
      for (Index v = start; v != none; v = m_next[v]) {
        const bool is_double =
            v != start && (m_tree.nodes[v].point - nodes[before].point).norm() < tiny;
        if (!is_double)
          append(m_tree.nodes[v]);
        number[v] = before;
        for (const Index c : m_child[v])
          if (c != m_next[v])
            stack.emplace_back(c, before);
      }
    }
    m_tree.nodes = std::move(nodes);
    m_number = std::move(number);
  }

  /// Weight of the cosine against the logarithm of the supported volume [-].
  static constexpr double straightness = 8;
  double m_spacing;
  Branch_tree m_tree;
  std::vector<std::vector<Index>> m_child;
  std::vector<Index> m_next, m_number;
  std::vector<double> m_carried; ///< sums of squared radii times lengths of descendants [L^3]
};

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_BRANCH_GROUPER_H
