// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Common topology of two trees under the growth hypothesis that explains them better.

#ifndef PCS_SHAPE_SPACE_PAIR_MATCH_TREES_H
#define PCS_SHAPE_SPACE_PAIR_MATCH_TREES_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/embedding/refine_yaw.h>
#include <pcs/shape_space/matching/Branch_matching.h>
#include <pcs/shape_space/matching/Match_confidences.h>
#include <pcs/shape_space/matching/build_topology.h>
#include <pcs/shape_space/matching/find_yaw_candidates.h>
#include <pcs/shape_space/model/Common_topology.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Relative error of lengths, moments and fractions of the possible cost by rounding. [-]
constexpr double matching_rounding = 1e-9;

/// Result of a matching of two trees in numbers.
struct Matching_cost
{
  double energy = 0; ///< in units of the kind of growth [-]
  double share =
      /// fraction of the possible cost: 0 if the larger tree contains the whole smaller tree, 1 if
      /// nothing is matched [-]
      0;
  bool is_at_tips = false; ///< whether it assumes growth at tips
  double yaw = 0;          ///< rotation about the vertical that aligns tree 2 with tree 1 [rad]
};

/*!
  Matches the branches of two trees; the result has no branches when `progress` asks to stop.

  The two kinds of growth have different units of energy. They are compared by the fraction of the
  possible cost, `(cost - least) / (most - least)`: `least` is the cost of the excess length of the
  larger tree, and `most` the cost if nothing is matched. Growth at tips is accepted only for a
  clearly smaller fraction. With growth along branches, the same holds for trunks that are not the
  longest or nearly longest paths.
*/
template <class ConcurrencyTag>
class Tree_matching
{
public:
  Tree_matching(const std::array<const Rooted_tree*, 2>& trees,
                const Matching_weights& weights,
                const Alignment_options& alignment,
                pcs::internal::Progress& progress,
                Common_topology& result)
    : m_trees(trees),
      m_weights(weights),
      m_alignment(alignment),
      m_progress(progress),
      m_result(result)
  {
  }

  Matching_cost run()
  {
    if (m_weights.growth != Branch_growth::at_tips || m_weights.is_published)
      if (!match_along_branches())
        return m_cost;
    if (m_weights.growth != Branch_growth::along_branches && !m_weights.is_published)
      match_at_tips();
    return m_cost;
  }

private:
  using Matching = Branch_matching<ConcurrencyTag>;
  using Result = std::shared_ptr<const Matched_branch>;

  // virtual trees that grew at their tips have ratios below 0.6; most plants with stretching leaves
  // have 0.7 and more; stretched branches then predict intermediate days better
  static constexpr double clearly = 2. / 3;
  // the longest path of a tomato plant is its stem and one of its leaves, which changes from day to
  // day; but among all paths, some path has a slightly lower cost by chance
  static constexpr double wide_fork_ratio = 0.3;

  static constexpr double any_cost = std::numeric_limits<double>::infinity();

  /// Least cost of two trees, and the additional cost if nothing is matched. [-]
  struct Range
  {
    double least, more;
  };
  Range range(double unit_1, double unit_2) const
  {
    const double a = m_trees[0]->weights[0] / unit_1, b = m_trees[1]->weights[0] / unit_2;
    const double least = m_weights.unmatched * std::min(1.0, m_weights.length) * std::abs(a - b);
    return {least, m_weights.unmatched * (a + b) - least};
  }

  void build(Matching& matching, const Result& trunk, bool is_at_tips, const Range& from)
  {
    matching.set_turn(m_cost.yaw, m_alignment.up);
    const auto confidences = Match_confidences<ConcurrencyTag>(matching).run(*trunk);
    m_result.paths = {matching.paths(0), matching.paths(1)};
    internal::Topology_builder builder(*m_trees[0], *m_trees[1], m_result.paths);
    m_result.branches = builder.run(*trunk, confidences);
    if (m_cost.yaw != 0)
      m_cost.yaw = refine_yaw(m_trees, m_result, m_alignment.up, m_cost.yaw);
    m_cost.is_at_tips = is_at_tips;
    m_cost.energy = std::max(0.0, trunk->cost); // rounding
    m_cost.share =
        from.more > 0 ? std::min(1.0, std::max(0.0, trunk->cost - from.least) / from.more) : 0;
  }

  std::array<Branch_paths, 2> paths(double other_ratio) const
  {
    return {Matching::find_paths(*m_trees[0], m_weights, other_ratio),
            Matching::find_paths(*m_trees[1], m_weights, other_ratio)};
  }

  /// Matches the trees with trunks that are the longest paths, or nearly so, unless other trunks
  /// have a clearly lower cost. Matchings of cost `most` or more are ignored.
  Result match_trunks(Matching& matching, const Range& from, double most)
  {
    const auto excess = [&](double cost) { return std::max(0.0, cost - from.least); };
    matching.use_other_trunks(false);
    // the exact cost is irrelevant if any other matching below `most` is clearly better
    const Result longest = matching.run(m_progress, from.least + excess(most) / clearly);
    const double least = longest ? from.least + clearly * excess(longest->cost) : most;
    if (m_progress.is_cancelled() || !matching.has_other_trunks())
      return longest;
    matching.use_other_trunks(true);
    const Result other = matching.run(m_progress, std::min(most, least));
    return other ? other : longest;
  }

  /// Matches the trees at the yaw of least cost; null if the cost is not below `most`.
  template <class Match>
  Result match_yaws(Matching& matching, const Range& from, double most, const Match& match)
  {
    Result best = match(most);
    if (m_progress.is_cancelled())
      return nullptr;
    double yaw = 0;
    if (m_alignment.alignment == Orl_alignment::rotate_about_up) {
      most = from.least +
             largest_ratio_with_yaw * std::max(0.0, (best ? best->cost : most) - from.least);
      for (const double angle : promising_yaws(matching)) {
        matching.set_turn(angle, m_alignment.up);
        if (Result found = match(most); found && found->cost < most) {
          best = std::move(found);
          most = best->cost;
          yaw = angle;
        }
      }
    }
    if (!best || m_progress.is_cancelled())
      return nullptr;
    m_cost.yaw = yaw;
    return best;
  }

  /// Finds yaws with a lower quick cost than without a rotation, the best first. [rad]
  std::vector<double> promising_yaws(Matching& matching) const
  {
    std::vector<double> angles = find_yaw_candidates<ConcurrencyTag>(matching.energy(),
                                                                     m_alignment.up,
                                                                     number_of_looks,
                                                                     m_progress);
    angles.insert(angles.begin(), 0);
    const std::size_t number = internal::find_yaw_limits(matching.energy()).number_of_children;
    std::vector<double> cost;
    for (const double angle : angles) {
      if (!m_progress(0))
        return {};
      matching.set_turn(angle, m_alignment.up);
      cost.push_back(matching.look(number));
    }
    std::vector<std::size_t> order(angles.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return cost[i] < cost[j];
    });
    std::vector<double> result;
    for (const std::size_t k : order)
      if (cost[k] < cost[0] && result.size() < number_of_yaws)
        result.push_back(angles[k]);
    return result;
  }

  bool match_along_branches()
  {
    Matching matching(*m_trees[0], *m_trees[1], m_weights, paths(wide_fork_ratio));
    const Range from = range(m_trees[0]->heights[0], m_trees[1]->heights[0]);
    const Result trunk = match_yaws(matching, from, any_cost, [&](double most) {
      return match_trunks(matching, from, most);
    });
    if (trunk)
      build(matching, trunk, false, from);
    return trunk != nullptr;
  }

  void match_at_tips()
  {
    if (m_weights.growth != Branch_growth::at_tips && m_cost.share <= matching_rounding)
      return; // nothing is left to explain
    const double highest = std::max(m_trees[0]->heights[0], m_trees[1]->heights[0]);
    const Range from = range(highest, highest);
    Matching matching(*m_trees[0], *m_trees[1], m_weights, paths(1), true);
    matching.set_number_of_trunk_trials(2 * m_weights.number_of_trials);
    // if both kinds of growth are tried, `m_cost` is the cost of growth along branches
    const double most = m_weights.growth == Branch_growth::at_tips
                            ? any_cost
                            : from.least + clearly * m_cost.share * from.more;
    const Result trunk = match_yaws(matching, from, most, [&](double limit) {
      Result found = matching.run(m_progress, limit);
      return found && found->cost < limit ? found : nullptr;
    });
    if (trunk)
      build(matching, trunk, true, from);
  }

  static constexpr std::size_t number_of_looks = 8, number_of_yaws = 2;
  // largest ratio of the costs with and without a yaw: noise lets some rotation of aligned
  // copies have a lower cost by chance
  static constexpr double largest_ratio_with_yaw = 0.95;

  std::array<const Rooted_tree*, 2> m_trees;
  const Matching_weights& m_weights;
  const Alignment_options& m_alignment;
  pcs::internal::Progress& m_progress;
  Common_topology& m_result;
  Matching_cost m_cost;
};

namespace internal {

/// Returns the second moment of the edges of a tree about its root, which is independent of the
/// pose. [L^3]
inline double second_moment(const Rooted_tree& tree)
{
  double sum = 0;
  for (std::size_t v = 1; v < tree.size(); ++v)
    sum += tree.edge_length(v) * tree.points[v].squaredNorm();
  return sum;
}

/// Returns whether `one` must be the first tree of a matching: it is shorter, or equally long and
/// more compact. Differences within rounding do not count.
inline bool is_clearly_shorter(const Rooted_tree& one, const Rooted_tree& two)
{
  for (const auto& [a, b] : {std::make_pair(one.weights[0], two.weights[0]),
                             std::make_pair(one.heights[0], two.heights[0]),
                             std::make_pair(second_moment(one), second_moment(two))})
    if (std::abs(a - b) > matching_rounding * (a + b))
      return a < b;
  return false;
}

} // namespace internal

/*!
  Matches the branches of two trees in a canonical order, so that swapped trees have the same
  matching. If the order is undecided, both are tried, and the matching with the smaller fraction of
  the possible cost is taken.
*/
template <class ConcurrencyTag>
Matching_cost match_trees(const std::array<const Rooted_tree*, 2>& trees,
                          const Matching_weights& weights,
                          const Alignment_options& alignment,
                          pcs::internal::Progress& progress,
                          Common_topology& result)
{
  using Matching = Tree_matching<ConcurrencyTag>;
  Matching_cost cost;
  cost.share = std::numeric_limits<double>::infinity();
  if (!internal::is_clearly_shorter(*trees[1], *trees[0])) {
    cost = Matching(trees, weights, alignment, progress, result).run();
    if (cost.share <= matching_rounding || progress.is_cancelled() ||
        internal::is_clearly_shorter(*trees[0], *trees[1]))
      return cost;
  }
  Common_topology back;
  Matching_cost cost_back =
      Matching({trees[1], trees[0]}, weights, alignment, progress, back).run();
  if (progress.is_cancelled()) {
    result = Common_topology();
    return cost_back;
  }
  if (!(cost_back.share < cost.share * (1 - matching_rounding)))
    return cost;
  cost_back.yaw = 0 - cost_back.yaw; // no negative zero
  std::swap(back.paths[0], back.paths[1]);
  for (Common_branch& b : back.branches) {
    std::swap(b.path[0], b.path[1]);
    std::swap(b.node[0], b.node[1]);
    std::swap(b.attachment[0], b.attachment[1]);
  }
  result = std::move(back);
  return cost_back;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PAIR_MATCH_TREES_H
