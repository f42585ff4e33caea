// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Decomposes a layer tree into chains: at every fork one child continues, the others begin a chain.

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

} // namespace internal

/// The chains: the longest that begins at a source, then the others, longest first. A chain begins
/// with the first node that is not its parent's. O(n log n).
inline std::vector<Chain> decompose_chains(const Scan& scan, const Layer_tree& tree)
{
  const std::size_t m = tree.size();
  const std::vector<double> height = internal::heights(tree);
  const Index_groups children(m, tree.parent);
  // A short way on from a node towards the farthest tip.
  const auto way_ahead = [&](Index v) {
    for (int step = 0; step < ahead_reach && !children[v].empty(); ++step)
      v = *std::max_element(children[v].begin(), children[v].end(), [&](Index a, Index b) {
        return height[a] < height[b];
      });
    return v;
  };
  // Where points are missing on the way to a child, only what lies straight ahead may belong to the
  // same branch.
  const auto is_crooked_gap = [&](Index v, Index c, const Vec3& along) {
    const Vec3 jump = tree.center[c] - tree.center[v];
    const double length = jump.norm();
    if (length <= gap_layers * layer_thickness * scan.spacing + tree.spread[v] + tree.spread[c])
      return false;
    const Index far = way_ahead(c);
    const Vec3 behind = tree.center[far] - tree.center[c];
    return along.dot(jump) < gap_cosine * length ||
           behind.dot(jump) < gap_cosine * length * behind.norm();
  };
  const auto main_child = [&](Index v) {
    const Index in_ring = tree.next_in_ring[v];
    if (in_ring != none)
      return in_ring == v ? none : in_ring;
    const Vec3 along = internal::direction_to(tree, v);
    Index best = none;
    double best_score = 0;
    for (const Index c : children[v]) {
      const Vec3 d = tree.center[way_ahead(c)] - tree.center[v];
      const double norm = d.norm(), cosine = norm > 0 ? along.dot(d) / norm : 0;
      if (is_crooked_gap(v, c, along))
        continue;
      const double u = scan.spacing;
      const double score = 0.5 * std::log(height[c] / u + layer_thickness) +
                           std::log(tree.spread[c] / u + spread_offset) +
                           chain_straightness * cosine;
      if (best == none || score > best_score) {
        best_score = score;
        best = c;
      }
    }
    return best;
  };
  std::vector<Chain> chains;
  std::vector<std::uint8_t> is_taken(m, 0);
  for (Index v = 0; v < m; ++v) { // parents come before their children
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
  // Ties are decided by what does not change when the scan is turned.
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
  return chains;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_DECOMPOSE_CHAINS_H
