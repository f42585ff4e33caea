// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds all axes of a scan: chains of layers, long ones first, in passes over what is not explained yet.

#ifndef PCS_SKELETON_FIT_AXES_H
#define PCS_SKELETON_FIT_AXES_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/Chain_fit.h>
#include <pcs/skeleton/Layer_tree.h>
#include <pcs/skeleton/Neighbor_graph.h>
#include <pcs/skeleton/drop_pairs.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Rules of the whole search.
struct Axis_rules
{
  Link_rule links;
  Chain_rules chains;
  int passes = 3;
  double later_links = 0.7; ///< links of later passes are this much shorter [-]
  //! replaces `Chain_rules::protrusion` in later passes, in spacings [-]
  double later_protrusion = 3;
  double first_noise = 0.3;      ///< noise before anything is known, in spacings [-]
  int most_cuts = 4;             ///< how often what is left of a chain is tried again
  std::size_t shortest_rest = 4; ///< layers that such a rest needs [count]
  Pair_rules pairs;
  std::size_t largest_wave = 64; ///< chains that are fitted side by side [count]
};

namespace internal {

/// The largest distance by which the axis leaves those that are there, in excess of the share of their radii.
inline double
protrusion_of(const Scan& scan, const Axis_set& set, const Axis& axis, double reach, double share)
{
  double best = -reach;
  for (std::size_t k = axis.size(); k-- > 0 && best < reach;) {
    const auto near =
        scan.search->nearest_if(axis[k].point, reach, [&](Index i) { return set.is_covered(i); });
    if (!(near.squared_distance < reach * reach))
      return reach;
    const Axis& other = set.axes[set.axis_of_point[near.index]].axis;
    const Axis_place place = nearest_place(other, set.segment_of_point[near.index], axis[k].point);
    best = std::max(best, place.distance - (1 + share) * radius_at(other, place));
  }
  return best;
}

/// Accepts candidates one after the other; each sees what the ones before it have covered.
inline bool accept(const Scan& scan,
                   const Chain_rules& rules,
                   Candidate& candidate,
                   Index parent,
                   Axis_set& set,
                   Scan_statistics& statistics)
{
  if (candidate.axis.size() < 2)
    return false;
  std::size_t count = 0;
  for (const Index i : candidate.points)
    count += !set.is_covered(i);
  if (count < rules.lowest_count ||
      double(count) < rules.explained * double(candidate.number_of_own_points))
    return false;
  if (!set.axes.empty()) {
    const double wanted = rules.protrusion * scan.spacing;
    if (protrusion_of(scan, set, candidate.axis, wanted, rules.protrusion_radius) < wanted)
      return false;
  }
  const Index number = static_cast<Index>(set.axes.size());
  for (std::size_t k = 0; k < candidate.points.size(); ++k) {
    const Index i = candidate.points[k];
    if (set.is_covered(i))
      continue;
    set.axis_of_point[i] = number;
    set.segment_of_point[i] = candidate.segments[k];
  }
  set.axes.push_back({std::move(candidate.axis), parent, count, 1});
  statistics.add_deviations(candidate.deviations);
  statistics.add_densities(candidate.densities);
  return true;
}

/// The stretches of a chain that nothing explains although a part of it was fitted.
inline std::vector<Chain>
rest_of(const Layer_tree& tree, const Axis_set& set, const Chain& chain, std::size_t fewest)
{
  std::vector<Chain> pieces;
  Chain piece;
  const auto finish = [&] {
    if (piece.nodes.size() >= fewest && piece.nodes.size() < chain.nodes.size())
      pieces.push_back(piece);
    piece = Chain();
  };
  Index before = chain.parent_node;
  for (const Index v : chain.nodes) {
    std::size_t open = 0;
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
      open += !set.is_covered(tree.point[k]);
    if (2 * open >= tree.count(v)) {
      if (piece.nodes.empty())
        piece.parent_node = before;
      else
        piece.length += (tree.center[v] - tree.center[piece.nodes.back()]).norm();
      piece.nodes.push_back(v);
    } else
      finish();
    before = v;
  }
  finish();
  return pieces;
}

/// Fits the chains of one tree of layers, in waves whose members do not see each other.
/// Whether it does learn about the surface: what the first pass has left over is not typical.
/// Returns `false` as soon as `progress` does, which sees a share of the work.
template <class ConcurrencyTag, class Progress>
bool fit_chains(const Scan& scan,
                const Layer_tree& tree,
                const Axis_rules& rules,
                Scan_statistics& statistics,
                Axis_set& set,
                bool does_learn,
                const Progress& progress)
{
  std::vector<Chain> chains = chains_of(scan, tree);
  std::vector<Index> axis_of_chain(chains.size(), none), chain_of_node(tree.size());
  for (Index c = 0; c < chains.size(); ++c)
    for (const Index v : chains[c].nodes)
      chain_of_node[v] = c;
  const auto parent_axis = [&](Index c) {
    while (chains[c].parent_node != none) {
      c = chain_of_node[chains[c].parent_node];
      if (axis_of_chain[c] != none)
        return axis_of_chain[c];
    }
    return none;
  };
  // the next chains to fit, longest first
  std::vector<Index> queue(chains.size());
  for (Index c = 0; c < queue.size(); ++c)
    queue[c] = c;
  std::vector<int> depth(chains.size(), 0);
  std::size_t wave = 1;
  std::vector<Candidate> candidates;
  for (std::size_t begin = 0; begin < queue.size();) {
    const std::size_t end = std::min(queue.size(), begin + wave);
    candidates.assign(end - begin, Candidate());
    pcs::internal::for_each_index<ConcurrencyTag>(
        end - begin,
        [&](std::size_t k) {
          candidates[k] = Chain_fit(scan, set, rules.chains)(tree, chains[queue[begin + k]]);
        },
        1);
    std::vector<Index> pieces;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const Index c = queue[begin + k];

      if (accept(scan, rules.chains, candidates[k], parent_axis(c), set, statistics))
        axis_of_chain[c] = static_cast<Index>(set.axes.size() - 1);
      if (depth[c] < rules.most_cuts)
        for (Chain& piece : rest_of(tree, set, chains[c], rules.shortest_rest)) {
          const Index number = static_cast<Index>(chains.size());
          for (const Index v : piece.nodes)
            chain_of_node[v] = number;
          chains.push_back(std::move(piece));
          axis_of_chain.push_back(none);
          depth.push_back(depth[c] + 1);
          pieces.push_back(number);
        }
    }
    if (does_learn || !(set.density > 0))
      statistics.learn(set);
    begin = end;
    if (!pieces.empty()) {
      queue.insert(queue.end(), pieces.begin(), pieces.end());
      std::stable_sort(queue.begin() + static_cast<std::ptrdiff_t>(begin),
                       queue.end(),
                       [&](Index x, Index y) { return chains[x].length > chains[y].length; });
    }
    if (!progress(double(end) / double(queue.size())))
      return false;
    wave = std::min(rules.largest_wave, 2 * wave);
  }
  return true;
}

/// In every component, the point nearest to an axis.
inline std::vector<Index> nearest_to_axes(const Scan& scan,
                                          const Axis_set& set,
                                          const std::vector<std::uint8_t>& is_used,
                                          const std::vector<Link>& links)
{
  const std::size_t n = scan.size();
  Point_sets sets(n);
  for (const Link& l : links)
    sets.unite(l.first, l.second);
  // a tree of the points of axes, where a search among all would pass many others, as in leaves
  std::vector<Vec3> covered;
  for (Index i = 0; i < n; ++i)
    if (set.is_covered(i))
      covered.push_back(scan.points[i]);
  constexpr double most = 0.9;
  if (double(covered.size()) > most * double(n))
    covered.clear();
  const neighborhood::Nearest_neighbors search(covered);
  const auto distance = [&](const Vec3& p, double reach) {
    const auto near =
        covered.empty()
            ? scan.search->nearest_if(p, reach, [&](Index j) { return set.is_covered(j); })
            : search.nearest_if(p, reach, [](Index) { return true; });
    return std::sqrt(near.squared_distance);
  };
  std::vector<Index> source(n, none);
  std::vector<double> best(n, std::numeric_limits<double>::infinity());
  for (Index i = 0; i < n; ++i) {
    if (!is_used[i])
      continue;
    const Index c = sets.find(i);
    if (source[c] == none)
      source[c] = i;
    const double reach = std::min(best[c], 1e3 * scan.spacing);
    const double d = distance(scan.points[i], reach);
    if (d < reach) {
      best[c] = d;
      source[c] = i;
    }
  }
  source.erase(std::remove(source.begin(), source.end(), none), source.end());
  std::sort(source.begin(), source.end());
  return source;
}

} // namespace internal

/*!
  All axes: those of the chains of `first_tree`, then those of the points that are left. What is found until `progress`
  returns `false` is returned.
*/
template <class ConcurrencyTag, class Progress>
Axis_set fit_axes(const Scan& scan,
                  const Layer_tree& first_tree,
                  const Axis_rules& rules,
                  const Progress& progress)
{
  const std::size_t n = scan.size();
  Axis_set set;
  set.axis_of_point.assign(n, none);
  set.segment_of_point.assign(n, none);
  set.noise = rules.first_noise * scan.spacing;
  Scan_statistics statistics;
  const auto share = [&](double from, double to) {
    return [&progress, from, to](double f) { return progress(from + (to - from) * f); };
  };
  if (!internal::fit_chains<ConcurrencyTag>(scan,
                                            first_tree,
                                            rules,
                                            statistics,
                                            set,
                                            true,
                                            share(0, 0.7)))
    return set;

  Axis_rules later = rules;
  later.chains.protrusion = rules.later_protrusion;
  later.links.local_factor *= rules.later_links;
  later.links.lowest *= rules.later_links;
  later.links.highest *= rules.later_links;
  for (int pass = 1; pass < rules.passes; ++pass) {
    std::vector<std::uint8_t> is_used(n);
    for (Index i = 0; i < n; ++i)
      is_used[i] = !scan.is_outlier[i] && !set.is_covered(i);
    const std::vector<Link> rest = neighbor_links<ConcurrencyTag>(scan, is_used, later.links);
    const std::vector<Index> sources = internal::nearest_to_axes(scan, set, is_used, rest);
    const Neighbor_graph graph = graph_of(n, rest);
    const Layer_tree tree = layer_tree(scan, rest, shortest_paths(scan, graph, sources));
    const double done = 0.7 + 0.3 * double(pass - 1) / double(rules.passes - 1);
    if (!internal::fit_chains<ConcurrencyTag>(scan,
                                              tree,
                                              later,
                                              statistics,
                                              set,
                                              false,
                                              share(done, done + 0.3 / double(rules.passes - 1))))
      return set;
  }
  drop_pairs(rules.pairs, set);
  return set;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FIT_AXES_H
