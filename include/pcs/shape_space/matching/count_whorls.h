// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Whether the pairs and whorls of branches of trees stay together on paths between the trees.

#ifndef PCS_SHAPE_SPACE_MATCHING_COUNT_WHORLS_H
#define PCS_SHAPE_SPACE_MATCHING_COUNT_WHORLS_H

#include <pcs/shape_space/matching/assign_whorls.h>
#include <pcs/shape_space/model/Common_topology.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Tree_family.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Whorls of two branches or more of each tree, and those whose members separate between trees.
struct Whorl_counts
{
  std::vector<std::size_t> number, broken; ///< per tree [count]
};

namespace internal {

/// Where branches begin: per tree and branch, the fraction of the length of the parent; NaN for a
/// branch that the tree lacks, or without parent. [-]
using Places = std::vector<std::vector<double>>;

constexpr double no_place = std::numeric_limits<double>::quiet_NaN();

/// The number of a node plus the fraction of the next edge, moved onto the parent, which has `last`
/// edges.
inline std::pair<std::size_t, double> edge_and_fraction(double attachment, std::size_t last)
{
  const double place = std::min(static_cast<double>(last), std::max(0.0, attachment));
  const std::size_t k = std::min(static_cast<std::size_t>(place), last - 1);
  return {k, place - static_cast<double>(k)};
}

inline double place_on_parent(const Common_topology& topology, std::size_t b, std::size_t t)
{
  const Common_branch& branch = topology.branches[b];
  if (branch.parent == none || branch.is_virtual(static_cast<int>(t)))
    return no_place;
  const std::vector<double>& node = topology.branches[branch.parent].node[t];
  const auto [k, fraction] = edge_and_fraction(branch.attachment[t], node.size() - 1);
  return node[k] + fraction * (node[k + 1] - node[k]);
}

inline double place_on_parent(const Tree_family& family, std::size_t b, std::size_t t)
{
  const std::size_t p = family.layout.branches[b].parent;
  if (p == none || !family.has[t][b] || !family.has[t][p])
    return no_place;
  const Orl_layout::Branch& parent = family.layout.branches[p];
  const auto edge = family.x[t].length.begin() + static_cast<std::ptrdiff_t>(parent.first_edge);
  const auto [k, fraction] = edge_and_fraction(family.x[t].attachment[b], parent.number_of_edges);
  const auto at = edge + static_cast<std::ptrdiff_t>(k);
  const double length =
      std::accumulate(edge, edge + static_cast<std::ptrdiff_t>(parent.number_of_edges), 0.0);
  return (std::accumulate(edge, at, 0.0) + fraction * *at) / length;
}

/// Returns whether the members of a whorl that another tree has are in one whorl there. `whorl_of`:
/// in the other tree, by the branch; `none`: in no whorl.
inline bool is_kept(const std::vector<std::size_t>& whorl,
                    const std::vector<double>& place,
                    const std::vector<std::size_t>& whorl_of)
{
  std::vector<std::size_t> partners;
  for (const std::size_t b : whorl)
    if (!std::isnan(place[b]))
      partners.push_back(whorl_of[b]);
  return partners.size() < 2 ||
         (partners[0] != none && std::count(partners.begin(), partners.end(), partners[0]) ==
                                     static_cast<std::ptrdiff_t>(partners.size()));
}

/// Finds the whorls of two or more of the branches `children` of one parent, for one tree.
inline Whorls whorls_below(const std::vector<std::size_t>& children,
                           const std::vector<double>& place)
{
  std::vector<std::size_t> own;
  std::vector<double> places;
  for (const std::size_t b : children)
    if (!std::isnan(place[b])) {
      own.push_back(b);
      places.push_back(place[b]);
    }
  Whorls result;
  for (const std::vector<std::size_t>& group : find_whorls(places))
    if (group.size() > 1) {
      result.emplace_back();
      for (const std::size_t k : group)
        result.back().push_back(own[k]);
    }
  return result;
}

/// Counts the whorls among the branches `children` of one parent.
inline void count_below(const std::vector<std::size_t>& children,
                        const Places& place,
                        std::vector<std::vector<std::size_t>>& whorl_of,
                        Whorl_counts& counts)
{
  std::vector<Whorls> whorls;
  for (std::size_t t = 0; t < place.size(); ++t) {
    whorls.push_back(whorls_below(children, place[t]));
    for (std::size_t w = 0; w < whorls[t].size(); ++w)
      for (const std::size_t b : whorls[t][w])
        whorl_of[t][b] = w;
  }
  for (std::size_t t = 0; t < place.size(); ++t)
    for (const std::vector<std::size_t>& whorl : whorls[t]) {
      bool is_whole = true;
      for (std::size_t u = 0; u < place.size(); ++u)
        is_whole = is_whole && (u == t || is_kept(whorl, place[u], whorl_of[u]));
      ++counts.number[t];
      counts.broken[t] += is_whole ? 0 : 1;
    }
}

/// `branches`: with their parents. `source`: argument of `place_on_parent()`.
template <class Branch, class Source>
Whorl_counts
count_whorls(const std::vector<Branch>& branches, const Source& source, std::size_t number_of_trees)
{
  const std::size_t n = branches.size();
  std::vector<std::vector<std::size_t>> children(n);
  Places place(number_of_trees, std::vector<double>(n));
  for (std::size_t b = 0; b < n; ++b) {
    if (branches[b].parent != none)
      children[branches[b].parent].push_back(b);
    for (std::size_t t = 0; t < number_of_trees; ++t)
      place[t][b] = place_on_parent(source, b, t);
  }
  std::vector<std::vector<std::size_t>> whorl_of(number_of_trees,
                                                 std::vector<std::size_t>(n, none));
  const std::vector<std::size_t> zero(number_of_trees, 0);
  Whorl_counts counts{zero, zero};
  for (const std::vector<std::size_t>& own : children)
    count_below(own, place, whorl_of, counts);
  return counts;
}

} // namespace internal

/// Counts the whorls of both trees. A whorl is broken if two of its members or more have partners,
/// but not in one whorl of the other tree. O(b log b) for b branches.
inline Whorl_counts count_whorls(const Common_topology& topology)
{
  return internal::count_whorls(topology.branches, topology, 2);
}

/// Counts the whorls of all trees. A whorl is broken if it is broken in any other tree.
/// O(n b (n + log b + e)) for n trees, b branches, and e edges of a branch.
inline Whorl_counts count_whorls(const Tree_family& family)
{
  return internal::count_whorls(family.layout.branches, family, family.x.size());
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_COUNT_WHORLS_H
