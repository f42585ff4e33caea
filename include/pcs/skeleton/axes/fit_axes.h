// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fit of all axes of a scan: chains by decreasing length, in rounds over unexplained points.

#ifndef PCS_SKELETON_AXES_FIT_AXES_H
#define PCS_SKELETON_AXES_FIT_AXES_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/axes/Chain_fit.h>
#include <pcs/skeleton/axes/Noise_and_density_model.h>
#include <pcs/skeleton/axes/drop_two_point_axes.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/model/Layer_tree.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the fit of all axes.
struct Axis_options
{
  Link_rule links;
  Chain_options chains;
  int passes = 3;
  double later_links = 0.7; ///< factor on the lengths of links after the first round [-]
  //! replaces `Chain_options::protrusion` after the first round, in spacings [-]
  double later_protrusion = 3;
  double first_noise = 0.3; ///< initial noise, in spacings [-]
  double first_guess =
      0.7; ///< ratio of measured to initial noise below which the first chain is refitted [-]
  double least_noise = 0.08;     ///< lower bound on the noise, in spacings [-]
  int most_cuts = 4;             ///< most successive fits of the remainder of a chain [count]
  std::size_t shortest_rest = 4; ///< least number of level sets of such a remainder [count]
  Two_point_axis_options pairs;
  std::size_t largest_wave = 64; ///< most chains that are fitted concurrently [count]
  double most_lost = 0.05;       ///< largest fraction of points lost to chains of the same wave [-]
};

namespace internal {

/// Returns the largest distance of the axis from the surfaces of existing ones, reduced by the
/// fraction `share` of their radii and clamped to [-reach, reach] [L].
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

/// Returns the fraction of the points of a candidate that other axes have covered since its fit.
inline double lost_share(const Candidate& candidate, const Axis_set& set)
{
  const std::size_t lost = static_cast<std::size_t>(
      std::count_if(candidate.points.begin(), candidate.points.end(), [&](Index i) {
        return set.is_covered(i);
      }));
  return candidate.points.empty() ? 0 : double(lost) / double(candidate.points.size());
}

/// Returns the fraction of all points on or inside an axis that lies inside its thick sections [-].
/// 0 without thick sections. O(points near the axis log n).
inline double
enclosed_share(const Scan& scan, const Chain_options& rules, double noise, const Axis& axis)
{
  const double thick = std::max(rules.thick * scan.spacing, rules.hollow * noise);
  const auto width = [&](double r) {
    return std::max(rules.filled_noise * noise, rules.filled_depth * r);
  };
  if (std::none_of(axis.begin(), axis.end(), [&](const Axis_node& node) {
        return node.radius >= thick;
      }))
    return 0;
  const auto reach = [&](std::size_t k) {
    const double r = axis[k].radius;
    const double length = k + 1 < axis.size() ? (axis[k + 1].point - axis[k].point).norm() : 0;
    return std::hypot(r + width(r), length);
  };
  const Axis_projector project(axis);
  Axis_place place;
  double inside = 0, all = 0;
  for (const Index i : points_near(scan, axis, reach)) {
    place = project(place.segment, scan.points[i]);
    const double r = radius_at(axis, place);
    if (scan.is_outlier[i] || place.share < 0 || place.share > 1 || place.distance > r + width(r))
      continue;
    ++all;
    inside += r >= thick && place.distance < r - width(r);
  }
  return all > 0 ? inside / all : 0;
}

/// Adds a candidate to `set` if it explains enough points that are not covered, protrudes from
/// existing axes, and does not enclose them. Returns whether it was added.
inline bool accept(const Scan& scan,
                   const Chain_options& rules,
                   Candidate& candidate,
                   Index parent,
                   Axis_set& set,
                   Noise_and_density_model& statistics)
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
    if (enclosed_share(scan, rules, set.noise, candidate.axis) > rules.enclosed)
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

/// Returns the stretches of a chain whose components have mostly unexplained points. Each stretch
/// has at least `fewest` components.
inline std::vector<Chain>
open_stretches(const Layer_tree& tree, const Axis_set& set, const Chain& chain, std::size_t fewest)
{
  std::vector<Chain> stretches;
  Chain stretch;
  const auto finish = [&] {
    if (stretch.nodes.size() >= fewest)
      stretches.push_back(stretch);
    stretch = Chain();
  };
  Index before = chain.parent_node;
  for (const Index v : chain.nodes) {
    std::size_t open = 0;
    for (Index k = tree.first[v]; k < tree.first[v + 1]; ++k)
      open += !set.is_covered(tree.point[k]);
    if (2 * open >= tree.count(v)) {
      if (stretch.nodes.empty())
        stretch.parent_node = before;
      else
        stretch.length += (tree.center[v] - tree.center[stretch.nodes.back()]).norm();
      stretch.nodes.push_back(v);
    } else
      finish();
    before = v;
  }
  finish();
  return stretches;
}

/// Chains of one tree of level-set components in the order of their fits, with the resulting axes.
class Chain_queue
{
public:
  Chain_queue(const Scan& scan, const Layer_tree& tree) : m_chain_of_node(tree.size())
  {
    add(decompose_chains(scan, tree), 0);
    m_number_of_sorted = size();
  }

  /// Returns the number of chains, including those that were fitted.
  std::size_t size() const { return m_order.size(); }
  const Chain& operator[](std::size_t place) const { return m_chains[m_order[place]]; }
  /// Returns the number of successive fits that left this chain as a remainder [count].
  int cuts(std::size_t place) const { return m_cuts[m_order[place]]; }

  /// Appends chains, or pieces of existing ones.
  void add(std::vector<Chain> chains, int cuts)
  {
    for (Chain& chain : chains) {
      const Index c = static_cast<Index>(m_chains.size());
      for (const Index v : chain.nodes)
        m_chain_of_node[v] = c;
      m_order.push_back(c);
      m_chains.push_back(std::move(chain));
      m_axis.push_back(none);
      m_cuts.push_back(cuts);
    }
  }

  /// Merges the appended chains into those from index `from` on, by decreasing length.
  void sort(std::size_t from)
  {
    const auto is_longer = [&](Index x, Index y) {
      return m_chains[x].length > m_chains[y].length;
    };
    const auto begin = m_order.begin();
    const auto added = begin + static_cast<std::ptrdiff_t>(m_number_of_sorted);
    std::stable_sort(added, m_order.end(), is_longer);
    std::inplace_merge(begin + static_cast<std::ptrdiff_t>(from), added, m_order.end(), is_longer);
    m_number_of_sorted = size();
  }

  void set_axis(std::size_t place, Index axis) { m_axis[m_order[place]] = axis; }

  /// Returns the axis of the nearest chain towards the root that has one, or `none`.
  Index parent_axis(std::size_t place) const
  {
    Index c = m_order[place];
    while (m_chains[c].parent_node != none) {
      c = m_chain_of_node[m_chains[c].parent_node];
      if (m_axis[c] != none)
        return m_axis[c];
    }
    return none;
  }

private:
  std::vector<Chain> m_chains;
  std::vector<Index> m_axis;  ///< of each chain; `none`: no axis
  std::vector<int> m_cuts;    ///< of each chain
  std::vector<Index> m_order; ///< numbers of chains
  std::vector<Index> m_chain_of_node;
  std::size_t m_number_of_sorted = 0;
};

/*!
  Fits the chains of one tree of level-set components in waves of independent fits. A chain that
  loses too many of its points to others of its wave is refitted later. Where a chain passes through
  components that are explained already, as a second arc of a trunk does, the stretches between them
  are fitted separately: points left beside an existing axis do not form one branch. `does_learn`:
  whether fits update noise and density; points left by the first round are not typical. Calls
  `progress` with the completed fraction of the work, and returns `false` as soon as it does.
*/
template <class ConcurrencyTag, class Progress>
bool fit_chains(const Scan& scan,
                const Layer_tree& tree,
                const Axis_options& rules,
                Noise_and_density_model& statistics,
                Axis_set& set,
                bool does_learn,
                const Progress& progress)
{
  Chain_queue queue(scan, tree);
  std::size_t wave = 1;
  std::vector<Candidate> candidates;
  std::vector<std::size_t> places; // indices of the chains of a wave
  for (std::size_t begin = 0; begin < queue.size();) {
    const std::size_t end = std::min(queue.size(), begin + wave);
    places.clear();
    for (std::size_t k = begin; k < end; ++k) {
      std::vector<Chain> open = open_stretches(tree, set, queue[k], 1);
      if (open.size() == 1 && open.front().nodes.size() == queue[k].nodes.size())
        places.push_back(k);
      else
        queue.add(std::move(open), queue.cuts(k));
    }
    const auto fit = [&] {
      candidates.assign(places.size(), Candidate());
      pcs::internal::for_each_index<ConcurrencyTag>(
          places.size(),
          [&](std::size_t k) {
            candidates[k] = Chain_fit(scan, set, rules.chains)(tree, queue[places[k]]);
          },
          1);
    };
    fit();
    // the noise is estimated from the trunk, and may differ much from its initial value
    if (begin == 0 && does_learn && !candidates.empty()) {
      const double noise = statistics.noise_of(candidates.front().deviations);
      if (noise > 0 && noise < rules.first_guess * set.noise) {
        set.noise = noise;
        fit();
      }
    }
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::size_t place = places[k];
      if (lost_share(candidates[k], set) > rules.most_lost) {
        queue.add({queue[place]}, queue.cuts(place));
        continue;
      }
      const Index parent = queue.parent_axis(place);
      if (accept(scan, rules.chains, candidates[k], parent, set, statistics))
        queue.set_axis(place, static_cast<Index>(set.axes.size() - 1));
      if (queue.cuts(place) >= rules.most_cuts)
        continue;
      std::vector<Chain> rest = open_stretches(tree, set, queue[place], rules.shortest_rest);
      if (rest.size() != 1 || rest.front().nodes.size() < queue[place].nodes.size())
        queue.add(std::move(rest), queue.cuts(place) + 1);
    }
    if (does_learn || !(set.density > 0))
      statistics.learn(set);
    begin = end;
    queue.sort(begin);
    if (!progress(double(end) / double(queue.size())))
      return false;
    wave = std::min(rules.largest_wave, 2 * wave);
  }
  return true;
}

/// Returns the point of every connected component that is nearest to an axis.
template <class ConcurrencyTag, class LinkRange>
std::vector<Index> nearest_to_axes(const Scan& scan,
                                   const Axis_set& set,
                                   const std::vector<std::uint8_t>& is_used,
                                   const LinkRange& links)
{
  const std::size_t n = scan.size();
  Point_sets sets = united_points<ConcurrencyTag>(n, links, [](const Link&) { return true; });
  // Separate search tree of covered points: among leaves, a search over all points would visit many
  // uncovered ones.
  std::vector<Vec3> covered;
  const auto count = static_cast<std::size_t>(std::count_if(set.axis_of_point.begin(),
                                                            set.axis_of_point.end(),
                                                            [](Index a) { return a != none; }));
  constexpr double most = 0.9;
  if (double(count) <= most * double(n)) {
    covered.reserve(count);
    for (Index i = 0; i < n; ++i)
      if (set.is_covered(i))
        covered.push_back(scan.points[i]);
  }
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

/// Returns the level sets of the points of `is_used`, along the paths from the points nearest to
/// the axes.
template <class ConcurrencyTag>
Layer_tree layers_of_rest(const Scan& scan,
                          const Axis_set& set,
                          const std::vector<std::uint8_t>& is_used,
                          const Link_rule& rule)
{
  const Compact_links links(ConcurrencyTag(), scan, is_used, rule);
  const std::vector<Index> sources = nearest_to_axes<ConcurrencyTag>(scan, set, is_used, links);
  const Shortest_paths paths = shortest_paths(scan, graph_of(scan.size(), links), sources);
  return layer_tree<ConcurrencyTag>(scan, links, paths);
}

} // namespace internal

/*!
  Fits all axes: first the chains of `first_tree`, then the unexplained points in further rounds.
  Returns the axes found so far if `progress` returns `false`.
*/
template <class ConcurrencyTag, class Progress>
Axis_set fit_axes(const Scan& scan,
                  const Layer_tree& first_tree,
                  const Axis_options& rules,
                  const Progress& progress)
{
  const std::size_t n = scan.size();
  Axis_set set;
  set.axis_of_point.assign(n, none);
  set.segment_of_point.assign(n, none);
  set.noise = rules.first_noise * scan.spacing;
  Noise_and_density_model statistics(rules.least_noise * scan.spacing);
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

  Axis_options later = rules;
  later.chains.protrusion = rules.later_protrusion;
  later.links.local_factor *= rules.later_links;
  later.links.lowest *= rules.later_links;
  later.links.highest *= rules.later_links;
  for (int pass = 1; pass < rules.passes; ++pass) {
    std::vector<std::uint8_t> is_used(n);
    for (Index i = 0; i < n; ++i)
      is_used[i] = !scan.is_outlier[i] && !set.is_covered(i);
    const Layer_tree tree =
        internal::layers_of_rest<ConcurrencyTag>(scan, set, is_used, later.links);
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
  drop_two_point_axes(rules.pairs, set);
  return set;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_FIT_AXES_H
