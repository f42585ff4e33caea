// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Top-down matching of the branches of two trees: children are assigned below matched parents.

#ifndef PCS_SHAPE_SPACE_MATCHING_BRANCH_MATCHING_H
#define PCS_SHAPE_SPACE_MATCHING_BRANCH_MATCHING_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/Child_assignment.h>
#include <pcs/shape_space/matching/Matching_energy.h>
#include <pcs/shape_space/matching/Matching_memo.h>
#include <pcs/shape_space/matching/compare_branches.h>
#include <pcs/shape_space/model/Branch_paths.h>
#include <pcs/shape_space/model/Matched_branch.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Searches for the matching of least energy.

  Two branches are matched in several trials, each with one pair of their candidate paths. In each
  trial, children are assigned at least cost; for this, pairs of children are matched recursively.
  All pairs of trunks are first matched with one trial per pair of children, then the best pairs of
  trunks again with more trials. If the trees turn out to be similar, all of this is repeated with
  more paths of limbs: where lengths vary, a limb may follow another child at a fork, and all its
  branches are then lost. Between unrelated trees, more paths have no use.
*/
template <class ConcurrencyTag>
class Branch_matching
{
  using Result = std::shared_ptr<const Matched_branch>;

public:
  /// `paths`: the candidate paths of all branches of the trees.
  Branch_matching(const Rooted_tree& tree_1,
                  const Rooted_tree& tree_2,
                  const Matching_weights& weights,
                  std::array<Branch_paths, 2> paths,
                  bool is_at_tips = false)
    : m_energy(tree_1, tree_2, weights, std::move(paths), is_at_tips, ConcurrencyTag()),
      m_number_of_trials(weights.number_of_trials),
      m_most_trunk_trials(trunk_factor * weights.number_of_trials)
  {
  }

  static Branch_paths
  find_paths(const Rooted_tree& tree, const Matching_weights& weights, double other_ratio = 1)
  {
    return find_branch_paths(tree,
                             weights.fork_ratio,
                             weights.is_published ? 1 : weights.number_of_paths,
                             weights.trunk_fork_ratio,
                             other_ratio);
  }

  const Branch_paths& paths(int t) const { return m_energy.paths(t); }
  const Matching_energy& energy() const { return m_energy; }

  /// Sets the number of pairs of trunks that are matched with all their children. Their
  /// matching takes most of the time.
  void set_number_of_trunk_trials(std::size_t n) { m_most_trunk_trials = n; }
  /// Fixes the trunk of tree 2, a path of `paths(1)`.
  void set_second_trunk(std::size_t path) { m_energy.set_second_trunk(path); }
  /// Returns whether there are `Branch_paths::other_trunks`.
  bool has_other_trunks() const { return !paths(0).other_trunks.empty(); }
  /// Selects whether the other trunks are matched. Memoised matchings of branches stay valid.
  void use_other_trunks(bool do_use)
  {
    if (do_use != m_uses_other_trunks)
      m_energy.swap_trunks();
    m_uses_other_trunks = do_use;
  }
  /// Rotates tree 2 as a whole about an axis in the coordinates of the caller. The energy does
  /// not include this rotation. [rad]
  void set_turn(double angle, const Vec3& axis)
  {
    const Eigen::Matrix3d before = m_rotation;
    m_rotation = Eigen::AngleAxisd(angle, m_energy.frame().transpose() * axis).toRotationMatrix();
    if (m_rotation == before)
      return;
    for (Matching_memo<Result>& answers : m_known)
      answers.forget();
    m_simple.forget();
  }

  /// Returns the rotation with which children of branches with a given rotation are matched. It is
  /// rounded, and bounds of costs hold for it only.
  Eigen::Matrix3d inherited_rotation(const Eigen::Matrix3d& rotation) const
  {
    return Matching_key(0, 0, rotation * m_rotation.transpose()).rotation() * m_rotation;
  }
  /// Returns the rotation of tree 2 as a whole.
  const Eigen::Matrix3d& rotation() const { return m_rotation; }
  /// Returns the cost of two children, if they have been matched, or a lower bound.
  double known_cost(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation) const
  {
    const Matching_key question(start_1, start_2, rotation * m_rotation.transpose());
    if (is_simple(start_1, start_2))
      if (const double* const cost = m_simple.find(question))
        return *cost;
    for (const std::size_t k : {3u, 2u, 1u, 0u})
      if (const Result* const answer = m_known[k].find(question))
        return *answer ? (*answer)->cost : std::numeric_limits<double>::infinity();
    return m_energy.least_cost(start_1, start_2, question.rotation() * m_rotation);
  }

  /// Matches two children, with one trial per pair of branches; infinity if they cost as much
  /// as unmatched.
  double quick_match(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation)
  {
    const Matching_key question(start_1, start_2, rotation * m_rotation.transpose());
    for (const std::size_t k : {3u, 1u})
      if (const Result* const answer = m_known[k].find(question))
        return Match_answer(*answer).cost;
    m_effort = 1;
    return match(start_1, start_2, rotation).cost;
  }

  /// Returns the cost of the most promising trunks, with one trial per pair of children. The trunks
  /// are found by their `number` heaviest children. [-]
  double look(std::size_t number = Matching_energy::most_children)
  {
    m_effort = 1;
    constexpr double any = std::numeric_limits<double>::infinity();
    return match_children(find_trials(0, 0, m_rotation, any, 1, number).front(), m_rotation, any)
        ->cost;
  }

  /// Returns null when `progress` asks to stop, or if the cost is not below `most_cost`.
  /// Matchings with few trials are admitted up to a slightly higher cost.
  std::shared_ptr<const Matched_branch>
  run(pcs::internal::Progress& progress,
      const double most_cost = std::numeric_limits<double>::infinity())
  {
    use_more_limbs(false);
    const Result first = search(progress, 0, most_cost);
    const Result best = first ? completed(*first) : nullptr;
    if (!best || !has_limbs() || unexplained_share(best->cost) >= largest_share || is_same(*best))
      return best;
    use_more_limbs(true);
    const Result other = search(progress, 0.5, below(best->cost));
    if (progress.is_cancelled())
      return nullptr;
    // few trials are admitted above the limit
    return other && other->cost < below(best->cost) ? completed(*other) : best;
  }

private:
  using Trial = Matching_energy::Trial;
  using Children = Matching_energy::Children;

  static constexpr double trunk_slack = 1.05;  // relative error of the cost with one trial
  static constexpr double largest_share = 0.5; // unexplained, of trees with a second search
  static constexpr double same = 1e-12;        // costs that differ by less are equal

  /// Returns the largest cost that is less than `cost` by more than rounding. Of matchings of the
  /// same cost, the first one is kept, so that the result does not depend on rounding.
  static double below(double cost) { return cost - same; }
  static double rounded(double cost) { return std::round(cost / same); }

  /// Matches all pairs of trunks, and the best ones again with more trials. Reports progress from
  /// `begin`, for a half of the search.
  Result search(pcs::internal::Progress& progress, double begin, double most_cost)
  {
    const Eigen::Matrix3d rotation = m_rotation;
    // even one trial of trunks with very many children is expensive
    const auto children = [&](int t) {
      return m_energy.path(t, paths(t).paths_of[0].front()).children.size();
    };
    const bool is_wide = std::max(children(0), children(1)) > most_children_at_once;
    std::vector<Trial> trials =
        find_trials(0, 0, rotation, most_cost, is_wide ? m_number_of_trials : m_most_trunk_trials);
    const std::size_t all = trials.size(), most = m_effort = m_number_of_trials;
    Result best;
    std::size_t number_done = 0;
    const auto is_stopped = [&] {
      return !progress(begin + static_cast<double>(number_done++) /
                                   static_cast<double>(2 * (all > most ? all + most : all)));
    };
    if (all > most) {
      m_effort = 1;
      std::vector<std::pair<double, std::size_t>> order;
      for (std::size_t k = 0; k < all; ++k) {
        if (is_stopped())
          return nullptr;
        const double limit = best ? trunk_slack * best->cost : trunk_slack * most_cost;
        if (Result result = match_children(trials[k], rotation, limit)) {
          order.emplace_back(rounded(result->cost), k);
          if (!best || result->cost < below(best->cost))
            best = std::move(result);
        }
      }
      std::sort(order.begin(), order.end());
      std::vector<Trial> chosen;
      for (std::size_t k = 0; k < order.size() && k < most; ++k)
        chosen.push_back(std::move(trials[order[k].second]));
      trials = std::move(chosen);
      m_effort = most;
    }
    for (Trial& trial : trials) {
      if (is_stopped())
        return nullptr;
      if (Result result =
              match_children(std::move(trial), rotation, best ? below(best->cost) : most_cost))
        best = std::move(result);
    }
    return best;
  }

  bool has_limbs() const { return !paths(0).limbs.empty() || !paths(1).limbs.empty(); }

  /// Returns whether all branches have partners of the same length: the trees differ in rotations
  /// only, and other paths cannot explain more.
  bool is_same(const Matched_branch& match) const
  {
    constexpr double tolerance = 1e-6;
    const std::size_t count = match.pairs.size();
    const double a = m_energy.length(0, match.path_1), b = m_energy.length(1, match.path_2);
    return count == m_energy.path(0, match.path_1).children.size() &&
           count == m_energy.path(1, match.path_2).children.size() &&
           std::abs(a - b) <= tolerance * std::max(a, b) &&
           std::all_of(match.pairs.begin(),
                       match.pairs.end(),
                       [this](const Matched_branch::Pair& pair) { return is_same(*pair.branch); });
  }

  /// Selects whether limbs have the paths of the second search. Memoised matchings stay valid.
  void use_more_limbs(bool do_use)
  {
    if (do_use != m_uses_more_limbs)
      m_energy.swap_limbs();
    m_uses_more_limbs = do_use;
  }

  /// Returns the fraction of the possible cost, see `Tree_matching`. [-]
  double unexplained_share(double cost) const
  {
    const double least = m_energy.least_difference(0, 0), more = single_cost(0, 0) - least;
    return more > 0 ? (cost - least) / more : 1;
  }

  /// Matches two children. The match of a simple pair is made at the end of the search, see
  /// `completed()`.
  Match_answer match(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation)
  {
    const Matching_key question(start_1, start_2, rotation * m_rotation.transpose());
    if (is_simple(start_1, start_2))
      return simple_cost(question, start_1, start_2);
    const bool is_limb_1 = m_uses_more_limbs && m_energy.is_limb(0, start_1),
               is_limb_2 = m_uses_more_limbs && m_energy.is_limb(1, start_2);
    Matching_memo<Result>& known =
        m_known[(is_limb_1 || is_limb_2 ? 2 : 0) + (m_effort == 1 ? 0 : 1)];
    if (const Result* const answer = known.find(question))
      return *answer;
    double limit = single_cost(start_1, start_2);
    const Eigen::Matrix3d turned = question.rotation() * m_rotation;
    Result best;
    const std::size_t number_of_trials =
        m_effort + (is_limb_1 && is_limb_2 && m_effort > 1 ? 1 : 0);
    for (Trial& trial : find_trials(start_1, start_2, turned, limit, number_of_trials))
      if (Result result = match_children(std::move(trial), turned, limit)) {
        limit = below(result->cost);
        best = std::move(result);
      }
    known.keep(question, best);
    return best;
  }

  /// Returns the cost of two subtrees that are not matched. [-]
  double single_cost(std::size_t start_1, std::size_t start_2) const
  {
    return m_energy.single_term(m_energy.weight(0, start_1)) +
           m_energy.single_term(m_energy.weight(1, start_2));
  }

  /// Returns whether two branches have a single path each, and one of them has no children. Then
  /// there is one trial and no choice, and only the cost is kept: most pairs are of this kind.
  bool is_simple(std::size_t start_1, std::size_t start_2) const
  {
    const auto &paths_1 = paths(0).paths_of[start_1], &paths_2 = paths(1).paths_of[start_2];
    return paths_1.size() == 1 && paths_2.size() == 1 &&
           (m_energy.path(0, paths_1[0]).children.empty() ||
            m_energy.path(1, paths_2[0]).children.empty());
  }

  /// Returns the cost of a simple pair, or infinity if it costs as much as unmatched. [-]
  double simple_cost(const Matching_key& question, std::size_t start_1, std::size_t start_2)
  {
    if (const double* const known = m_simple.find(question))
      return *known;
    const double limit = single_cost(start_1, start_2);
    const Eigen::Matrix3d turned = question.rotation() * m_rotation;
    const std::size_t p1 = paths(0).paths_of[start_1][0], p2 = paths(1).paths_of[start_2][0];
    double cost = std::numeric_limits<double>::infinity();
    if (m_energy.weights().curve * m_energy.least_energy(p1, p2, turned) +
            m_energy.least_difference(start_1, start_2) <
        limit) {
      Trial trial = first_trial(m_energy, p1, p2, turned);
      if (m_energy.is_turned() || trial.cost < limit)
        cost = single_children_cost(compare_branches(m_energy, std::move(trial), turned), turned);
    }
    if (!(cost < limit))
      cost = std::numeric_limits<double>::infinity();
    m_simple.keep(question, cost);
    return cost;
  }

  /// Returns the cost of two branches whose children are unmatched. [-]
  double single_children_cost(const Compared_branches& both, const Eigen::Matrix3d& inherited) const
  {
    const Trial& trial = both.trial;
    double cost =
        m_energy.is_turned() ? m_energy.turned_energy(trial, inherited, both.rotation) : trial.cost;
    cost += m_energy.rest_cost(trial.path_1, trial.path_2, trial.last);
    for (const Children& children : both.children)
      for (const double w : children.weight)
        cost += m_energy.single_term(w);
    return cost;
  }

  /// Returns a copy of a matching with the matchings of its simple pairs.
  Result completed(const Matched_branch& match)
  {
    auto result = std::make_shared<Matched_branch>(match);
    const Eigen::Matrix3d rotation =
        m_energy.frame().transpose() * match.rotation * m_energy.frame();
    for (Matched_branch::Pair& pair : result->pairs) {
      const std::size_t start_1 = m_energy.path(0, match.path_1).children[pair.child_1].start;
      const std::size_t start_2 = m_energy.path(1, match.path_2).children[pair.child_2].start;
      if (pair.branch) {
        pair.branch = completed(*pair.branch);
        continue;
      }
      const Eigen::Matrix3d turned = inherited_rotation(rotation);
      pair.branch = match_children(first_trial(m_energy,
                                               paths(0).paths_of[start_1][0],
                                               paths(1).paths_of[start_2][0],
                                               turned),
                                   turned,
                                   std::numeric_limits<double>::infinity());
    }
    return result;
  }

  /// Returns the nodes after the compared parts of two paths, or their tips.
  std::array<std::size_t, 2> compared_ends(std::size_t p1, std::size_t p2) const
  {
    const std::array<std::size_t, 2> last = m_energy.last_nodes(p1, p2);
    const std::vector<std::size_t>&nodes_1 = m_energy.path(0, p1).nodes,
          &nodes_2 = m_energy.path(1, p2).nodes;
    return {nodes_1[std::min(last[0] + 1, nodes_1.size() - 1)],
            nodes_2[std::min(last[1] + 1, nodes_2.size() - 1)]};
  }

  /// Finds pairs of paths that may continue two branches, the most promising first by costs without
  /// the subtrees of their `number` heaviest children. Pairs that cost at least `limit` by
  /// themselves are left out.
  std::vector<Trial> find_trials(std::size_t start_1,
                                 std::size_t start_2,
                                 const Eigen::Matrix3d& rotation,
                                 double limit,
                                 std::size_t most,
                                 std::size_t number = Matching_energy::most_children) const
  {
    const auto &paths_1 = paths(0).paths_of[start_1], &paths_2 = paths(1).paths_of[start_2];
    const double difference = m_energy.least_difference(start_1, start_2);
    const double curve_weight = m_energy.weights().curve;
    const bool is_turned = m_energy.is_turned(), is_alone = paths_1.size() * paths_2.size() == 1;
    std::vector<Trial> chosen;
    const auto take = [&](std::size_t p1, std::size_t p2) {
      Trial trial = first_trial(m_energy, p1, p2, rotation);
      if (is_turned || trial.cost < limit)
        chosen.push_back(std::move(trial));
    };
    struct Candidate
    {
      double cost;
      std::size_t p1, p2;
    };
    using limits = std::numeric_limits<double>;
    std::vector<Candidate> order;
    std::vector<double> lowest; // the lowest costs, a heap
    Matching_energy::Child_cost_cache prices;
    std::set<std::array<std::size_t, 2>> known;
    for (const std::size_t p1 : paths_1)
      for (const std::size_t p2 : paths_2) {
        if (curve_weight * m_energy.least_energy(p1, p2, rotation) + difference >= limit)
          continue;
        // paths that differ only beyond their cut are equivalent
        if (!is_alone && !known.insert(compared_ends(p1, p2)).second)
          continue;
        double cost = 0;
        if (!is_alone) {
          const double most_cost = lowest.size() < most ? limits::infinity() : lowest.front();
          cost = m_energy.quick_cost_of_paths(p1, p2, rotation, most_cost, prices, number);
          if (cost > most_cost)
            continue;
          if (lowest.size() == most) {
            std::pop_heap(lowest.begin(), lowest.end());
            lowest.pop_back();
          }
          lowest.push_back(cost);
          std::push_heap(lowest.begin(), lowest.end());
        }
        order.push_back({cost, p1, p2});
      }
    std::stable_sort(order.begin(), order.end(), [](const Candidate& x, const Candidate& y) {
      return rounded(x.cost) < rounded(y.cost);
    });
    for (std::size_t k = 0; k < order.size() && k < most; ++k)
      take(order[k].p1, order[k].p2);
    return chosen;
  }

  /// Matches the subtrees on two curves. Returns null as soon as the cost is known not to be below
  /// `limit`.
  Result match_children(Trial first, const Eigen::Matrix3d& rotation, double limit)
  {
    if (!m_energy.is_turned() && first.cost >= limit)
      return nullptr;
    const Compared_branches both = compare_branches(m_energy, std::move(first), rotation);
    const Trial& trial = both.trial;
    auto result = std::make_shared<Matched_branch>();
    result->cost =
        m_energy.is_turned() ? m_energy.turned_energy(trial, rotation, both.rotation) : trial.cost;
    result->cost += m_energy.rest_cost(trial.path_1, trial.path_2, trial.last);
    if (result->cost >= limit)
      return nullptr;
    result->path_1 = trial.path_1;
    result->path_2 = trial.path_2;
    result->last = trial.last;
    result->rotation = m_energy.frame() * both.rotation * m_energy.frame().transpose();
    for (const double w : both.children[0].weight)
      result->cost += m_energy.single_term(w);
    for (const double w : both.children[1].weight)
      result->cost += m_energy.single_term(w);
    const auto match_pair = [&](std::size_t start_1, std::size_t start_2) {
      return match(start_1, start_2, both.rotation);
    };
    // with the rounded rotation of the exact costs, otherwise some bounds exceed them
    const Eigen::Matrix3d inherited = inherited_rotation(both.rotation);
    const Child_assignment<ConcurrencyTag, decltype(match_pair)> assignment(m_energy,
                                                                            both.children,
                                                                            inherited,
                                                                            match_pair,
                                                                            limit);
    if (!assignment.add_pairs(*result))
      return nullptr;
    return result;
  }

  Matching_energy m_energy;
  Eigen::Matrix3d m_rotation = Eigen::Matrix3d::Identity(); // of tree 2
  bool m_uses_other_trunks = false, m_uses_more_limbs = false;
  std::size_t m_number_of_trials, m_most_trunk_trials;
  std::size_t m_effort = m_number_of_trials; // trials per pair below the trunks
  // with one trial per pair and with more, then the same for limbs with more paths
  std::array<Matching_memo<Result>, 4> m_known;
  Matching_memo<double> m_simple; // costs of simple pairs
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_BRANCH_MATCHING_H
