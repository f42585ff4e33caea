// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The common topology of two trees, for the kind of growth that explains more of what differs.

#ifndef PCS_SHAPE_SPACE_MATCH_TREES_H
#define PCS_SHAPE_SPACE_MATCH_TREES_H

#include <pcs/internal/progress.h>
#include <pcs/shape_space/Branch_matching.h>
#include <pcs/shape_space/Common_topology.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

namespace pcs {
namespace shape_space {

/// Of a matching of two trees.
struct Matching_cost
{
  double energy = 0; ///< in units of the kind of growth [-]
  double share =
      0; ///< of what it could cost: 0 if the smaller tree is all found in the other, 1 if nothing is [-]
  bool is_at_tips = false; ///< which kind of growth it is
};

/*!
  Matches the branches of two trees; the result has no branches when `progress` asks to stop.

  The energies of the two kinds of growth are in units of their own. What the greater tree has more costs in any case, and
  what is above that is compared with what it would be if nothing were matched; growth at tips must leave clearly less of it.
  So must other trunks than the longest paths, or nearly as long ones, for trees that grow along their branches.
*/
template <class ConcurrencyTag>
Matching_cost match_trees(const std::array<const Rooted_tree*, 2>& trees,
                          const Matching_weights& weights,
                          pcs::internal::Progress& progress,
                          Common_topology& result)
{
  const std::array<double, 2> height = {trees[0]->heights[0], trees[1]->heights[0]};
  const double highest = std::max(height[0], height[1]);
  // what two trees cost at least, and what they cost more if nothing is matched
  const auto range = [&](double unit_1, double unit_2) {
    const double a = trees[0]->weights[0] / unit_1, b = trees[1]->weights[0] / unit_2;
    const double least = weights.single * std::min(1.0, weights.length) * std::abs(a - b);
    return std::make_pair(least, weights.single * (a + b) - least); // [-]
  };
  using Result = std::shared_ptr<const Matched_branch>;
  Matching_cost cost;
  const auto build = [&](const Branch_matching<ConcurrencyTag>& matching,
                         const Result& trunk,
                         bool is_at_tips,
                         const std::pair<double, double>& from) {
    result.paths = {matching.paths(0), matching.paths(1)};
    internal::Topology_builder builder(*trees[0], *trees[1], result.paths);
    result.branches = builder.run(*trunk);
    cost.is_at_tips = is_at_tips;
    cost.energy = trunk->cost;
    cost.share = from.second > 0 ? std::max(0.0, trunk->cost - from.first) / from.second : 0;
  };
  double most = std::numeric_limits<double>::infinity();
  const auto along = range(height[0], height[1]), at_tips = range(highest, highest);
  if (weights.growth != Growth::at_tips || weights.is_published) {
    Branch_matching<ConcurrencyTag> matching(*trees[0], *trees[1], weights);
    const Result trunk = matching.run(progress);
    if (!trunk)
      return cost;
    build(matching, trunk, false, along);
    // virtual trees that grew at their tips leave less than 0.6 of it; of plants whose leaves stretch most leave 0.7 and more,
    // and the days between others are predicted better by stretched branches then
    constexpr double clearly = 2. / 3;
    // the longest path through a tomato is its stem and one of its leaves, on every day another one; but of all paths some
    // other one matches at a little less cost by chance
    constexpr double wide_fork_ratio = 0.3;
    Matching_weights wide = weights;
    wide.trunk_fork_ratio = wide_fork_ratio;
    if (weights.number_of_paths > 1 && wide_fork_ratio < weights.trunk_fork_ratio &&
        !weights.is_published) {
      Branch_matching<ConcurrencyTag> other(*trees[0], *trees[1], wide);
      if (const Result found =
              other.run(progress, along.first + clearly * cost.share * along.second))
        build(other, found, false, along);
    }
    most = at_tips.first + clearly * cost.share * at_tips.second;
  }
  if (weights.growth == Growth::along_branches || weights.is_published)
    return cost;
  Branch_matching<ConcurrencyTag> matching(*trees[0], *trees[1], weights, true);
  matching.set_number_of_trunk_trials(2 * weights.number_of_trials);
  const Result trunk = matching.run(progress, most);
  if (trunk)
    build(matching, trunk, true, at_tips);
  return cost;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCH_TREES_H
