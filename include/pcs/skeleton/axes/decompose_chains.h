// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Path decomposition of a layer tree: one child continues the chain at every fork.

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

/// Nodes of a layer tree from the base to a tip.
struct Chain
{
  std::vector<Index> nodes;
  Index parent_node = none; ///< the node of another chain that it sprouts from
  double length = 0;        ///< along the centres [L]
};

/// How many layers back the direction of a chain is taken from, and how many ahead that of a child
/// [count].
constexpr int direction_reach = 6, ahead_reach = 3;
/// Added to the spread of a node, in spacings: thin nodes must not win by noise [-].
constexpr double spread_offset = 0.4;
/// Farther children than this many layers lie behind a gap; the way there must be this straight
/// before and behind it [-].
constexpr double gap_layers = 1.5, gap_cosine = 0.8;
/// What a unit of the cosine between both counts against the logarithms of height and spread:
/// branches are straight [-].
constexpr double chain_straightness = 5;

namespace internal {

/// Longest way from each node to a tip below it.
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

inline Vec3 direction_to(const Layer_tree& tree, Index node)
{
  Index from = node;
  for (int k = 0; k < direction_reach && tree.parent[from] != none; ++k)
    from = tree.parent[from];
  const Vec3 d = tree.center[node] - tree.center[from];
  const double length = d.norm();
  return length > 0 ? Vec3(d / length) : Vec3(Vec3::Zero());
}

/// Chooses the child of a node that continues the same branch.
class Main_child
{
public:
  Main_child(const Scan& scan, const Layer_tree& tree)
    : m_scan(scan), m_tree(tree), m_height(heights(tree)), m_children(tree.size(), tree.parent)
  {
  }

  /// `none` where the branch ends.
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
      const double score = 0.5 * std::log(m_height[c] / u + layer_thickness) +
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
  /// A few layers from a node towards its farthest tip.
  Index ahead(Index v) const
  {
    for (int step = 0; step < ahead_reach && !m_children[v].empty(); ++step)
      v = *std::max_element(m_children[v].begin(), m_children[v].end(), [&](Index a, Index b) {
        return m_height[a] < m_height[b];
      });
    return v;
  }

  /// Where points are missing between a node and its child, only a child straight ahead may belong
  /// to the same branch.
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
  std::vector<double> m_height;
  Index_groups m_children;
};

/// Sorts chains by decreasing length, the first chain from a source to the front. Ties are decided
/// by what does not change when the scan is rotated.
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

/// Decomposes the tree of layers into chains: the longest that begins at a source, then the others
/// by decreasing length. A chain begins with the first node that does not continue its parent's
/// chain. O(n log n).
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
