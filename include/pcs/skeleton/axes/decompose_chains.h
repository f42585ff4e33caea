// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Path decomposition of a tree of level-set components: one child continues the chain at each fork.

#ifndef PCS_SKELETON_AXES_DECOMPOSE_CHAINS_H
#define PCS_SKELETON_AXES_DECOMPOSE_CHAINS_H

#include <pcs/skeleton/model/Index_groups.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Path of level-set components from a base to a tip.
struct Chain
{
  std::vector<Index> nodes;
  Index parent_node = none; ///< node of the chain from which this one branches
  double length = 0;        ///< along the centers [L]
};

/// Numbers of level sets behind and ahead of a fork that define the directions of the chain and of
/// a child [count].
constexpr int direction_reach = 6, ahead_reach = 3;
/// Offset of the spread of a node, in spacings: reduces the effect of noise on thin nodes [-].
constexpr double spread_offset = 0.4;
/// Distance to a child, in thicknesses of a level set, beyond which there is a gap, and least
/// cosine of the angles between the gap and the chain on both sides [-].
constexpr double gap_layers = 1.5, gap_cosine = 0.8;
/// Weights of the cosine between both directions, since branches are straight, and of the
/// logarithm of the height times the number of points beyond, against the logarithm of the spread
/// [-].
constexpr double chain_straightness = 5, chain_size = 0.25;

namespace internal {

/// Returns the length of the longest path from each node to a tip among its descendants [L].
inline std::vector<double> heights(const Layer_tree& tree)
{
  std::vector<double> height(tree.size(), 0);
  for (std::size_t v = tree.size(); v-- > 0;)
    if (tree.parent[v] != none) {
      double& h = height[tree.parent[v]];
      h = std::max(h, height[v] + (tree.center[v] - tree.center[tree.parent[v]]).norm());
    }
  return height;
}

/// Returns the number of points of each node and its descendants.
inline std::vector<double> points_beyond(const Layer_tree& tree)
{
  std::vector<double> count(tree.size(), 0);
  for (std::size_t v = tree.size(); v-- > 0;) {
    count[v] += double(tree.count(static_cast<Index>(v)));
    if (tree.parent[v] != none)
      count[tree.parent[v]] += count[v];
  }
  return count;
}

inline Vec3 direction_to(const Layer_tree& tree, Index node)
{
  Index from = node;
  for (int k = 0; k < direction_reach && tree.parent[from] != none; ++k)
    from = tree.parent[from];
  const Vec3 d = tree.center[node] - tree.center[from];
  const double length = d.norm();
  return length > 0 ? Vec3(d / length) : Vec3(Vec3::Zero());
}

/// Selection of the child that continues the branch of a node.
class Main_child
{
public:
  Main_child(const Scan& scan, const Layer_tree& tree)
    : m_scan(scan),
      m_tree(tree),
      m_height(heights(tree)),
      m_count(points_beyond(tree)),
      m_children(tree.size(), tree.parent)
  {
  }

  /// Returns the main child of `v`; `none` where the branch ends.
  Index operator()(Index v) const
  {
    const Index in_ring = m_tree.next_in_ring[v];
    if (in_ring != none)
      return in_ring == v ? none : in_ring;
    const Vec3 along = direction_to(m_tree, v);
    Index best = none;
    double best_score = 0;
    for (const Index c : m_children[v]) {
      const Vec3 d = m_tree.center[ahead(c)] - m_tree.center[v];
      const double norm = d.norm(), cosine = norm > 0 ? along.dot(d) / norm : 0;
      if (is_crooked_gap(v, c, along))
        continue;
      const double u = m_scan.spacing;
      const double height = m_height[c] / u + layer_thickness;
      const double score = chain_size * std::log(height * m_count[c]) +
                           std::log(m_tree.spread[c] / u + spread_offset) +
                           chain_straightness * cosine;
      if (best == none || score > best_score) {
        best_score = score;
        best = c;
      }
    }
    return best;
  }

private:
  /// Returns the node a few level sets ahead towards the farthest tip.
  Index ahead(Index v) const
  {
    for (int step = 0; step < ahead_reach && !m_children[v].empty(); ++step)
      v = *std::max_element(m_children[v].begin(), m_children[v].end(), [&](Index a, Index b) {
        return m_height[a] < m_height[b];
      });
    return v;
  }

  /// Returns whether `c` lies behind a gap without points and not straight ahead, so that it does
  /// not continue the branch of `v`.
  bool is_crooked_gap(Index v, Index c, const Vec3& along) const
  {
    const Vec3 jump = m_tree.center[c] - m_tree.center[v];
    const double length = jump.norm();
    if (length <=
        gap_layers * layer_thickness * m_scan.spacing + m_tree.spread[v] + m_tree.spread[c])
      return false;
    const Index far = ahead(c);
    const Vec3 behind = m_tree.center[far] - m_tree.center[c];
    return along.dot(jump) < gap_cosine * length ||
           behind.dot(jump) < gap_cosine * length * behind.norm();
  }

  const Scan& m_scan;
  const Layer_tree& m_tree;
  std::vector<double> m_height, m_count;
  Index_groups m_children;
};

/// Sorts chains by decreasing length, and moves the first one that begins at a source to the front.
/// Ties are broken by rotation-invariant properties.
inline void sort_chains(const Layer_tree& tree, std::vector<Chain>& chains)
{
  const auto key = [&](const Chain& c) {
    std::size_t points = 0;
    for (const Index v : c.nodes)
      points += tree.count(v);
    return std::make_tuple(c.length, points, tree.spread[c.nodes.front()]);
  };
  std::stable_sort(chains.begin(), chains.end(), [&](const Chain& a, const Chain& b) {
    return a.length != b.length ? a.length > b.length : key(a) > key(b);
  });
  const auto trunk = std::find_if(chains.begin(), chains.end(), [](const Chain& c) {
    return c.parent_node == none;
  });
  if (trunk != chains.end())
    std::rotate(chains.begin(), trunk, trunk + 1);
}

} // namespace internal

/// Decomposes the tree of level-set components into chains. The first is the longest of those that
/// begin at a source; the others follow by decreasing length. A chain begins with a node that does
/// not continue the chain of its parent. O(n log n).
inline std::vector<Chain> decompose_chains(const Scan& scan, const Layer_tree& tree)
{
  const internal::Main_child main_child(scan, tree);
  std::vector<Chain> chains;
  std::vector<std::uint8_t> is_taken(tree.size(), 0);
  for (Index v = 0; v < tree.size(); ++v) { // parents come before their children
    if (is_taken[v])
      continue;
    Chain chain;
    chain.parent_node = tree.parent[v];
    for (Index w = v; w != none; w = main_child(w)) {
      is_taken[w] = 1;
      if (!chain.nodes.empty())
        chain.length += (tree.center[w] - tree.center[chain.nodes.back()]).norm();
      chain.nodes.push_back(w);
    }
    chains.push_back(std::move(chain));
  }
  internal::sort_chains(tree, chains);
  return chains;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_DECOMPOSE_CHAINS_H
