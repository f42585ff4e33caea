// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The lowest part of the stem of a tree, among plants and objects on the ground.

#ifndef PCS_SKELETON_CLUTTER_STEM_IN_BINS_H
#define PCS_SKELETON_CLUTTER_STEM_IN_BINS_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the search for the stem in bins.
struct Stem_bin_options
{
  double bin = 0.01; ///< height of a bin / vertical extent; the height is at least 4 spacings [-]
  int bins = 12;     ///< lowest bins, in which the stem is searched [count]
  bool do_compare_links = true; ///< otherwise, the largest linked component continues the stem
  double rival = 0.1; ///< least fraction of the links of the stem that another candidate has [-]
  double crown = 0.5; ///< lower end of the crown that decides between them / vertical extent [-]
};

namespace internal {

/// Low points of a scan in bins of equal height, from below.
struct Low_bins
{
  double low = 0, high = 0, height = 0;    ///< nearly all points lie between `low` and `high`
  std::vector<Index> bin;                  ///< of each point; `none`: too high, or not used
  std::vector<std::vector<Index>> members; ///< points by bin

  Low_bins(const Scan& scan,
           const std::vector<double>& height_of,
           const Stem_bin_options& rules,
           const std::vector<std::uint8_t>& is_used)
    : bin(scan.size(), none), members(static_cast<std::size_t>(rules.bins))
  {
    const Index n = static_cast<Index>(scan.size());
    std::vector<float> heights;
    for (Index i = 0; i < n; ++i)
      if (is_used[i])
        heights.push_back(static_cast<float>(height_of[i]));
    if (heights.empty())
      return;
    const std::size_t tail = heights.size() / 1000;
    low = double(pcs::internal::value_of_rank(heights, tail));
    high = double(pcs::internal::value_of_rank(heights, heights.size() - 1 - tail));
    height = std::max(rules.bin * (high - low), 4 * scan.spacing);
    for (Index i = 0; i < n; ++i) {
      const double b = (height_of[i] - low) / height;
      if (is_used[i] && b < double(rules.bins)) {
        bin[i] = static_cast<Index>(std::max(0.0, b));
        members[bin[i]].push_back(i);
      }
    }
  }
};

/*!
  Returns which of several candidates for a stem carries the crown: the connected component in a
  bin that most points of the crown reach by their shortest paths. `sets`: components in the bin;
  `is_above`: points above the bin that are linked to the candidates; `crown`: lowest height of the
  crown [L]. Smaller indices win ties. O(links).
*/
template <class IsInBin>
Index carrier_of_crown(const Scan& scan,
                       const Compact_links& links,
                       const std::vector<double>& height_of,
                       double crown,
                       const std::vector<std::uint8_t>& is_above,
                       const IsInBin& is_in_bin,
                       Point_sets& sets)
{
  const Index n = static_cast<Index>(scan.size());
  std::vector<Index> sources;
  const Neighbor_graph graph(n, [&](const auto& visit) {
    for_each_link(links, [&](const Link& l) {
      const bool is_first = is_above[l.first] != 0, is_second = is_above[l.second] != 0;
      if ((is_first && (is_second || is_in_bin(l.second))) || (is_second && is_in_bin(l.first)))
        visit(l);
    });
  });
  for (Index i = 0; i < n; ++i)
    if (is_in_bin(i) && graph.begin(i) != graph.end(i))
      sources.push_back(i);
  const Shortest_paths paths = shortest_paths(scan, graph, sources);
  std::vector<Index> source(n, none), chain;
  for (const Index s : sources)
    source[s] = s;
  std::map<Index, std::size_t> votes;
  for (Index i = 0; i < n; ++i) {
    if (!is_above[i] || height_of[i] < crown)
      continue;
    Index at = i;
    for (chain.clear(); source[at] == none && paths.predecessor[at] != at;
         at = paths.predecessor[at])
      chain.push_back(at);
    if (source[at] == none)
      continue;
    for (const Index j : chain)
      source[j] = source[at];
    ++votes[sets.find(source[at])];
  }
  Index best = none;
  for (const auto& [set, count] : votes)
    if (best == none || count > votes[best])
      best = set;
  return best;
}

/// The points of the stem in each bin.
struct Stem_in_bins
{
  std::vector<std::vector<Index>> bins;
  bool is_linked = false; ///< whether they are linked from the crown to the lowest bin
};

/// Returns the points of the stem in each bin. The stem is tracked downwards from the dominant
/// component above the bins, by its number of points times its squared height, through the
/// connected components with the most links to the part above; below a gap, through the largest
/// component. If several components of the highest bin carry the component above, such as a stem
/// and a wall that the crown touches, the paths from the crown decide.
inline Stem_in_bins stem_in_bins(const Scan& scan,
                                 const Compact_links& links,
                                 const std::vector<double>& height_of,
                                 const std::vector<std::uint8_t>& is_used,
                                 const Low_bins& bins,
                                 const Stem_bin_options& rules)
{
  const Index n = static_cast<Index>(scan.size());
  const std::size_t count = bins.members.size();
  Point_sets above(n), sets(n); // connected components above all bins, and in each of them
  Links across;
  for_each_link(links, [&](const Link& l) {
    if (!is_used[l.first] || !is_used[l.second])
      return;
    const Index a = bins.bin[l.first], b = bins.bin[l.second];
    if (a == b)
      (a == none ? above : sets).unite(l.first, l.second);
    else
      across.push_back(l);
  });
  std::vector<Index> size(n, 0);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> top(n, -infinity), bottom(n, infinity); // of components above all bins
  for (Index i = 0; i < n; ++i)
    if (is_used[i]) {
      ++size[bins.bin[i] == none ? above.find(i) : sets.find(i)];
      if (bins.bin[i] == none) {
        const Index a = above.find(i);
        top[a] = std::max(top[a], height_of[i]);
        bottom[a] = std::min(bottom[a], height_of[i]);
      }
    }
  Index tallest = none;
  const auto score = [&](Index a) { return double(size[a]) * std::pow(top[a] - bottom[a], 2); };
  for (Index i = 0; i < n; ++i)
    if (is_used[i] && bins.bin[i] == none &&
        (tallest == none || score(above.find(i)) > score(tallest)))
      tallest = above.find(i);
  Stem_in_bins stem{std::vector<std::vector<Index>>(count), true};
  std::vector<std::uint8_t> is_stem(n, 0);
  std::vector<Index> contact(n, 0); // links of components with the stem above
  bool is_found = false;            // whether a bin has contact with the stem above
  for (Index i = 0; i < n && tallest != none; ++i)
    is_stem[i] = is_used[i] && bins.bin[i] == none && above.find(i) == tallest;
  for (std::size_t b = count; b-- > 0;) {
    Index part = none;
    const auto offer = [&](Index i) {
      const Index s = sets.find(i);
      const auto rank = [&](Index t) {
        return std::make_pair(rules.do_compare_links ? contact[t] : Index(contact[t] > 0), size[t]);
      };
      if (part == none || rank(s) > rank(part) || (rank(s) == rank(part) && s < part))
        part = s;
    };
    for (const Link& l : across) {
      if (bins.bin[l.first] == b && is_stem[l.second] && bins.bin[l.second] > b)
        ++contact[sets.find(l.first)];
      if (bins.bin[l.second] == b && is_stem[l.first] && bins.bin[l.first] > b)
        ++contact[sets.find(l.second)];
    }
    for (const Index i : bins.members[b])
      offer(i);
    if (rules.do_compare_links && part != none && contact[part] > 0 && !is_found) {
      is_found = true;
      const bool has_rival =
          std::any_of(bins.members[b].begin(), bins.members[b].end(), [&](Index i) {
            const Index s = sets.find(i);
            return s != part && double(contact[s]) >= rules.rival * double(contact[part]);
          });
      const Index carrier = has_rival ? carrier_of_crown(
                                            scan,
                                            links,
                                            height_of,
                                            bins.low + rules.crown * (bins.high - bins.low),
                                            is_stem,
                                            [&](Index i) { return bins.bin[i] == b; },
                                            sets)
                                      : none;
      part = carrier != none ? carrier : part;
    }
    stem.is_linked = stem.is_linked && part != none && contact[part] > 0;
    for (const Index i : bins.members[b])
      if (sets.find(i) == part) {
        stem.bins[b].push_back(i);
        is_stem[i] = 1;
      }
  }
  return stem;
}

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_STEM_IN_BINS_H
