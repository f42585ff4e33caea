// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Whether the pairs and whorls of branches of two trees stay together on the path between them.

#ifndef PCS_SHAPE_SPACE_MATCHING_COUNT_WHORLS_H
#define PCS_SHAPE_SPACE_MATCHING_COUNT_WHORLS_H

#include <pcs/shape_space/matching/assign_whorls.h>
#include <pcs/shape_space/model/Common_topology.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Whorls of two branches or more of each tree, and those whose members separate on the path.
struct Whorl_counts
{
  std::array<std::size_t, 2> number = {0, 0}, broken = {0, 0}; ///< [count]
};

namespace internal {

/// Returns the position of the base of a branch on its parent in tree `t`, as a fraction of the
/// length of the parent. [-]
inline double place_on_parent(const Common_topology& topology, std::size_t b, std::size_t t)
{
  const Common_branch& branch = topology.branches[b];
  const std::vector<double>& node = topology.branches[branch.parent].node[t];
  const double last = static_cast<double>(node.size() - 1);
  const double place = std::min(last, std::max(0.0, branch.attachment[t]));
  const auto k = static_cast<std::size_t>(std::min(place, last - 1));
  return node[k] + (place - static_cast<double>(k)) * (node[k + 1] - node[k]);
}

/// Adds the whorls of tree `t` below one parent, whose branches are `children`. `whorl_of`: in the
/// other tree, by the branch; `none`: in no whorl.
inline void count_below(const Common_topology& topology,
                        const std::vector<std::size_t>& children,
                        const Whorls& whorls,
                        const std::vector<std::size_t>& whorl_of,
                        std::size_t t,
                        Whorl_counts& counts)
{
  for (const std::vector<std::size_t>& whorl : whorls) {
    if (whorl.size() < 2)
      continue;
    ++counts.number[t];
    std::vector<std::size_t> partners;
    for (const std::size_t k : whorl)
      if (!topology.branches[children[k]].is_virtual(1 - static_cast<int>(t)))
        partners.push_back(whorl_of[children[k]]);
    const bool is_kept =
        partners.size() < 2 ||
        (partners[0] != none && std::count(partners.begin(), partners.end(), partners[0]) ==
                                    static_cast<std::ptrdiff_t>(partners.size()));
    counts.broken[t] += is_kept ? 0 : 1;
  }
}

} // namespace internal

/// Counts the whorls of both trees. A whorl is broken if two of its members or more have partners,
/// but not in one whorl of the other tree. O(b log b) for b branches.
inline Whorl_counts count_whorls(const Common_topology& topology)
{
  const std::size_t n = topology.branches.size();
  std::vector<std::vector<std::size_t>> children(n);
  for (std::size_t b = 0; b < n; ++b)
    if (topology.branches[b].parent != none)
      children[topology.branches[b].parent].push_back(b);
  Whorl_counts counts;
  std::array<std::vector<std::size_t>, 2> whorl_of = {std::vector<std::size_t>(n, none),
                                                      std::vector<std::size_t>(n, none)};
  for (std::size_t parent = 0; parent < n; ++parent) {
    std::array<std::vector<std::size_t>, 2> own;
    std::array<Whorls, 2> whorls;
    for (std::size_t t = 0; t < 2; ++t) {
      std::vector<double> place;
      for (const std::size_t b : children[parent])
        if (!topology.branches[b].is_virtual(static_cast<int>(t))) {
          own[t].push_back(b);
          place.push_back(internal::place_on_parent(topology, b, t));
        }
      whorls[t] = find_whorls(place);
      for (std::size_t w = 0; w < whorls[t].size(); ++w)
        for (const std::size_t k : whorls[t][w])
          if (whorls[t][w].size() > 1)
            whorl_of[t][own[t][k]] = w;
    }
    for (std::size_t t = 0; t < 2; ++t)
      internal::count_below(topology, own[t], whorls[t], whorl_of[1 - t], t, counts);
  }
  return counts;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_COUNT_WHORLS_H
