// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Top-down matching of the branches of two trees: children are assigned below matched parents.

#ifndef PCS_SHAPE_SPACE_MATCHING_BRANCH_MATCHING_H
#define PCS_SHAPE_SPACE_MATCHING_BRANCH_MATCHING_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/shape_space/matching/Matching_energy.h>
#include <pcs/shape_space/matching/Matching_memo.h>
#include <pcs/shape_space/matching/assign_whorls.h>
#include <pcs/shape_space/matching/compare_branches.h>
#include <pcs/shape_space/matching/linear_assignment.h>
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
#include <numeric>
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
        return Answer(*answer).cost;
    m_effort = 1;
    return match(start_1, start_2, rotation).cost;
  }

  /// Returns the cost of the most promising trunks, with one trial per pair of children. [-]
  double look()
  {
    m_effort = 1;
    constexpr double any = std::numeric_limits<double>::infinity();
    return match_children(find_trials(0, 0, m_rotation, any, 1).front(), m_rotation, any)->cost;
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

  static constexpr std::size_t most_at_once = 512; // children that are assigned at a time
  static constexpr double trunk_slack = 1.05;      // relative error of the cost with one trial
  static constexpr double largest_share = 0.5;     // unexplained, of trees with a second search
  static constexpr double unknown = -1;            // cost that was not computed
  static constexpr double same = 1e-12;            // costs that differ by less are equal

  /// Returns the largest cost that is less than `cost` by more than rounding. Of matchings of the
  /// same cost, the first one is kept, so that the result does not depend on rounding.
  static double below(double cost) { return cost - same; }
  static double rounded(double cost) { return std::round(cost / same); }

  /// The cost of two children, infinite if they cost as much as unmatched [-], and their matching.
  /// The matching of a simple pair is made at the end of the search, see `completed()`.
  struct Answer
  {
    Answer(double c) : cost(c) {}
    Answer(const Result& r) : cost(r ? r->cost : std::numeric_limits<double>::infinity()), branch(r)
    {
    }
    double cost;
    Result branch;
  };

  /// Matches all pairs of trunks, and the best ones again with more trials. Reports progress from
  /// `begin`, for a half of the search.
  Result search(pcs::internal::Progress& progress, double begin, double most_cost)
  {
    const Eigen::Matrix3d rotation = m_rotation;
    // even one trial of trunks with very many children is expensive
    const auto children = [&](int t) {
      return m_energy.path(t, paths(t).paths_of[0].front()).children.size();
    };
    const bool is_wide = std::max(children(0), children(1)) > most_at_once;
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

  Answer match(std::size_t start_1, std::size_t start_2, const Eigen::Matrix3d& rotation)
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
  /// the subtrees of their children. Pairs that cost at least `limit` by themselves are left out.
  std::vector<Trial> find_trials(std::size_t start_1,
                                 std::size_t start_2,
                                 const Eigen::Matrix3d& rotation,
                                 double limit,
                                 std::size_t most) const
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
          cost = m_energy.quick_cost_of_paths(p1, p2, rotation, most_cost, prices);
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
    const Branch_path &path_1 = m_energy.path(0, first.path_1),
                      &path_2 = m_energy.path(1, first.path_2);
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
    if (!assign_children(path_1,
                         path_2,
                         both.children[0],
                         both.children[1],
                         both.rotation,
                         limit,
                         *result))
      return nullptr;
    return result;
  }

  /// Adds the pairs of children and their gains; returns `false` if the cost is not below `limit`.
  /// Very many children are assigned in batches, the heaviest first, so time and memory grow
  /// linearly with their number. Batches do not divide whorls.
  bool assign_children(const Branch_path& path_1,
                       const Branch_path& path_2,
                       const Children& a,
                       const Children& b,
                       const Eigen::Matrix3d& turned,
                       double limit,
                       Matched_branch& result)
  {
    const bool may_keep = m_energy.weights().do_keep_whorls && !m_energy.weights().is_published;
    std::array<Whorls, 2> groups;
    if (may_keep && !(groups[0] = find_whorls(a.s)).empty())
      groups[1] = find_whorls(b.s);
    const bool are_whorls = !groups[1].empty();
    if (std::max(a.s.size(), b.s.size()) <= most_at_once) {
      const std::array<std::vector<std::size_t>, 2> all = {by_index(a), by_index(b)};
      return assign_some(path_1,
                         path_2,
                         a,
                         b,
                         all,
                         are_whorls ? &groups : nullptr,
                         turned,
                         limit,
                         result);
    }
    if (!are_whorls)
      groups = {single_whorls(a.s.size()), single_whorls(b.s.size())};
    assign_in_batches(path_1, path_2, a, b, std::move(groups), are_whorls, turned, result);
    return result.cost < limit;
  }

  void assign_in_batches(const Branch_path& path_1,
                         const Branch_path& path_2,
                         const Children& a,
                         const Children& b,
                         std::array<Whorls, 2> groups,
                         bool are_whorls,
                         const Eigen::Matrix3d& turned,
                         Matched_branch& result)
  {
    sort_by_weight(a, groups[0]);
    sort_by_weight(b, groups[1]);
    std::array<Whorls, 2> open;
    std::array<std::size_t, 2> next = {0, 0};
    while (next[0] < groups[0].size() || next[1] < groups[1].size()) {
      for (std::size_t t = 0; t < 2; ++t) {
        // the lightest unmatched children are tried once more
        while (number_of_members(open[t]) > most_at_once)
          open[t].erase(open[t].begin());
        for (std::size_t n = 0; next[t] < groups[t].size() && n < most_at_once; ++next[t]) {
          n += groups[t][next[t]].size();
          open[t].push_back(groups[t][next[t]]);
        }
      }
      const std::array<std::vector<std::size_t>, 2> chosen = {members_of(open[0]),
                                                              members_of(open[1])};
      const std::array<Whorls, 2> whorls = {renumbered(open[0]), renumbered(open[1])};
      const std::size_t first = result.pairs.size();
      assign_some(path_1,
                  path_2,
                  a,
                  b,
                  chosen,
                  are_whorls ? &whorls : nullptr,
                  turned,
                  std::numeric_limits<double>::infinity(),
                  result);
      for (std::size_t k = first; k < result.pairs.size(); ++k) {
        erase_whorl(open[0], result.pairs[k].child_1);
        erase_whorl(open[1], result.pairs[k].child_2);
      }
    }
    std::sort(result.pairs.begin(), result.pairs.end(), [](const auto& x, const auto& y) {
      return x.child_1 < y.child_1;
    });
  }

  static std::vector<std::size_t> by_index(const Children& children)
  {
    std::vector<std::size_t> order(children.s.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    return order;
  }

  /// Sorts groups of children by decreasing weight.
  static void sort_by_weight(const Children& children, Whorls& groups)
  {
    const auto weight = [&](const std::vector<std::size_t>& group) {
      double sum = 0;
      for (const std::size_t i : group)
        sum += children.weight[i];
      return sum;
    };
    std::stable_sort(groups.begin(), groups.end(), [&](const auto& x, const auto& y) {
      return weight(x) > weight(y);
    });
  }

  /// Assigns some children of both branches, first by lower bounds of their costs. Then the costs
  /// of assigned pairs are replaced by exact ones, until the costs of all assigned pairs are exact.
  /// `whorls`: by position in `chosen`, or null.
  bool assign_some(const Branch_path& path_1,
                   const Branch_path& path_2,
                   const Children& a,
                   const Children& b,
                   const std::array<std::vector<std::size_t>, 2>& chosen,
                   const std::array<Whorls, 2>* whorls,
                   const Eigen::Matrix3d& turned,
                   double limit,
                   Matched_branch& result)
  {
    const std::vector<std::size_t>&rows = chosen[0], &columns = chosen[1];
    const std::size_t n = rows.size(), m = columns.size();
    std::vector<double> gain(n * m);
    std::vector<Answer> exact(n * m, Answer(unknown));
    const double parent_length = m_energy.length(0, result.path_1);
    const auto rest = [&](std::size_t i, std::size_t j) {
      return m_energy.position_term(a.length[i], b.length[j], a.s[i], b.s[j], parent_length) -
             m_energy.single_term(a.weight[i]) - m_energy.single_term(b.weight[j]);
    };
    std::array<std::vector<std::size_t>, 2> starts;
    for (const std::size_t i : rows)
      starts[0].push_back(a.start[i]);
    for (const std::size_t j : columns)
      starts[1].push_back(b.start[j]);
    // with the rounded rotation of the exact costs, otherwise some bounds exceed them
    m_energy.least_costs(starts[0],
                         starts[1],
                         inherited_rotation(turned),
                         [&](std::size_t r, std::size_t c, double least) {
                           gain[r * m + c] = least + rest(rows[r], columns[c]);
                         });
    const auto match_pair = [&](std::size_t r, std::size_t c) {
      const std::size_t i = rows[r], j = columns[c];
      Answer& found = exact[r * m + c];
      found = match(path_1.children[i].start, path_2.children[j].start, turned);
      gain[r * m + c] = std::isfinite(found.cost) ? found.cost + rest(i, j) : 0;
    };
    const auto make_exact = [&](auto& assignment) {
      return make_pairs_exact(a,
                              b,
                              rows,
                              columns,
                              match_pair,
                              limit,
                              gain,
                              exact,
                              assignment,
                              result);
    };
    if (whorls != nullptr) {
      Whorl_assignment assignment((*whorls)[0], (*whorls)[1], gain);
      return make_exact(assignment);
    }
    Assignment assignment(n, m, gain);
    assignment.solve();
    return make_exact(assignment);
  }

  /// Replaces the bounds of assigned pairs by exact costs until all of them are exact. Adds the
  /// pairs and their gains; returns `false` if the cost is not below `limit`.
  template <class MatchPair, class Pairs>
  bool make_pairs_exact(const Children& a,
                        const Children& b,
                        const std::vector<std::size_t>& rows,
                        const std::vector<std::size_t>& columns,
                        const MatchPair& match_pair,
                        double limit,
                        const std::vector<double>& gain,
                        const std::vector<Answer>& exact,
                        Pairs& assignment,
                        Matched_branch& result)
  {
    const std::size_t n = rows.size(), m = columns.size();
    const std::vector<std::size_t>& partner = assignment.columns();
    std::vector<std::size_t> wanted;
    for (;;) {
      wanted.clear();
      double bound = result.cost;
      for (std::size_t r = 0; r < n; ++r)
        if (partner[r] != none) {
          bound += gain[r * m + partner[r]];
          if (exact[r * m + partner[r]].cost == unknown)
            wanted.push_back(r);
        }
      if (bound >= limit)
        return false;
      if (wanted.empty())
        break;
      keep_heaviest(a, b, rows, columns, partner, wanted);
      pcs::internal::for_each_index<ConcurrencyTag>(
          wanted.size(),
          [&](std::size_t k) { match_pair(wanted[k], partner[wanted[k]]); },
          1);
      assignment.raise(wanted);
    }
    for (std::size_t r = 0; r < n; ++r)
      if (partner[r] != none) {
        result.cost += gain[r * m + partner[r]];
        result.pairs.push_back({rows[r], columns[partner[r]], exact[r * m + partner[r]].branch});
      }
    return true;
  }

  /// Keeps the rows of the heaviest pairs: if the cost exceeds the limit, few pairs often show it.
  static void keep_heaviest(const Children& a,
                            const Children& b,
                            const std::vector<std::size_t>& rows,
                            const std::vector<std::size_t>& columns,
                            const std::vector<std::size_t>& partner,
                            std::vector<std::size_t>& wanted)
  {
    constexpr std::size_t fewest = 16, part = 3;
    const std::size_t number = std::max(fewest, wanted.size() / part);
    if (wanted.size() <= number)
      return;
    const auto weight = [&](std::size_t r) {
      return a.weight[rows[r]] + b.weight[columns[partner[r]]];
    };
    std::stable_sort(wanted.begin(), wanted.end(), [&](std::size_t r, std::size_t s) {
      return weight(r) > weight(s);
    });
    wanted.resize(number);
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
