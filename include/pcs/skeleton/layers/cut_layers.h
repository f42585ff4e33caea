// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Level sets of the geodesic distance from the root, and the tree of their components.

#ifndef PCS_SKELETON_LAYERS_CUT_LAYERS_H
#define PCS_SKELETON_LAYERS_CUT_LAYERS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/layers/join_sparse_layers.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Numbers the level-set components by their lowest level set, then by their first point.
inline void number_layer_parts(Point_sets& sets, const std::vector<Index>& layer, Layer_tree& tree)
{
  const std::size_t n = layer.size();
  std::vector<Index> order;        // first point of each component
  std::vector<Index> lowest_layer; // of each component
  std::vector<Index> part(n, none);
  for (Index i = 0; i < n; ++i) {
    if (layer[i] == none)
      continue;
    const Index r = sets.find(i);
    if (part[r] == none) {
      part[r] = static_cast<Index>(order.size());
      order.push_back(i);
      lowest_layer.push_back(layer[i]);
    }
    lowest_layer[part[r]] = std::min(lowest_layer[part[r]], layer[i]);
  }
  std::vector<Index> number(order.size());
  std::vector<Index> sorted(order.size());
  for (Index k = 0; k < sorted.size(); ++k)
    sorted[k] = k;
  std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) {
    return std::make_pair(lowest_layer[a], order[a]) < std::make_pair(lowest_layer[b], order[b]);
  });
  for (Index k = 0; k < sorted.size(); ++k)
    number[sorted[k]] = k;
  tree.parent.assign(order.size(), none);
  for (Index i = 0; i < n; ++i)
    if (layer[i] != none)
      tree.node_of_point[i] = number[part[sets.find(i)]];
}

/// Groups the points by level-set component, and computes the center and spread of each.
template <class ConcurrencyTag>
void collect_nodes(const Scan& scan, Layer_tree& tree)
{
  const std::size_t n = scan.size(), m = tree.size();
  tree.first.assign(m + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (tree.node_of_point[i] != none)
      ++tree.first[tree.node_of_point[i] + 1];
  for (std::size_t v = 0; v < m; ++v)
    tree.first[v + 1] += tree.first[v];
  tree.point.resize(tree.first[m]);
  std::vector<Index> next(tree.first.begin(), tree.first.end() - 1);
  for (Index i = 0; i < n; ++i)
    if (tree.node_of_point[i] != none)
      tree.point[next[tree.node_of_point[i]]++] = i;
  tree.center.assign(m, Vec3::Zero());
  tree.spread.assign(m, 0);
  pcs::internal::for_each_index<ConcurrencyTag>(m, [&](std::size_t node) {
    const Index v = static_cast<Index>(node);
    const double count = double(tree.count(v));
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
      tree.center[v] += scan.points[tree.point[k]];
    tree.center[v] /= count;
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
      tree.spread[v] += (scan.points[tree.point[k]] - tree.center[v]).squaredNorm();
    tree.spread[v] = std::sqrt(tree.spread[v] / count);
  });
}

/// Selects the parent of each node: the node from which most of the shortest paths to its points
/// arrive. In a tie, the node with more points is selected, then the node with the larger spread.
template <class ConcurrencyTag>
void vote_for_parents(const std::vector<Index>& predecessor, Layer_tree& tree)
{
  const auto vote = [&](Index v, std::vector<Index>& votes) {
    votes.clear();
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k) {
      const Index from = tree.node_of_point[predecessor[tree.point[k]]];
      if (from < v) // a joined level set may have points below and above a thin one
        votes.push_back(from);
    }
    std::sort(votes.begin(), votes.end());
    std::size_t best = 0;
    for (std::size_t b = 0, e = 0; b < votes.size(); b = e) {
      while (e < votes.size() && votes[e] == votes[b])
        ++e;
      const Index other = tree.parent[v], node = votes[b];
      const bool is_tie_won =
          e - b == best && std::make_pair(tree.count(node), tree.spread[node]) >
                               std::make_pair(tree.count(other), tree.spread[other]);
      if (e - b > best || is_tie_won) {
        best = e - b;
        tree.parent[v] = votes[b];
      }
    }
  };
  pcs::internal::for_each_block<ConcurrencyTag>(tree.size(),
                                                pcs::internal::default_block,
                                                [&](std::size_t begin, std::size_t end) {
                                                  std::vector<Index> votes;
                                                  for (std::size_t v = begin; v < end; ++v)
                                                    vote(static_cast<Index>(v), votes);
                                                });
}

} // namespace internal

/*!
  Cuts the points into level sets of the length of their shortest paths. Returns the tree of the
  connected components of these level sets. `links` are the edges of the graph of `paths`;
  `spacings` is the thickness of a level set in spacings.
*/
template <class ConcurrencyTag, class LinkRange>
Layer_tree layer_tree(const Scan& scan,
                      const LinkRange& links,
                      const Shortest_paths& paths,
                      double spacings = layer_thickness)
{
  const std::size_t n = scan.size();
  const double thickness = spacings * scan.spacing;
  std::vector<Index> layer(n, none);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    if (std::isfinite(paths.distance[i]))
      layer[i] = static_cast<Index>(std::min(paths.distance[i] / thickness, double(none - 1)));
  });
  Layer_tree tree;
  tree.node_of_point.assign(n, none);
  Point_sets sets = united_points<ConcurrencyTag>(n, links, [&](const Link& l) {
    return layer[l.first] == layer[l.second] && layer[l.first] != none;
  });
  join_sparse_layers<ConcurrencyTag>(scan,
                                     links,
                                     paths.distance,
                                     layer,
                                     thickness,
                                     Sparse_layer_options(),
                                     sets);
  internal::number_layer_parts(sets, layer, tree);
  internal::collect_nodes<ConcurrencyTag>(scan, tree);
  internal::vote_for_parents<ConcurrencyTag>(paths.predecessor, tree);
  tree.next_in_ring.assign(tree.size(), none);
  return tree;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_CUT_LAYERS_H
