// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Assignment of the children of two matched branches at least cost, in batches if there are many.

#ifndef PCS_SHAPE_SPACE_MATCHING_CHILD_ASSIGNMENT_H
#define PCS_SHAPE_SPACE_MATCHING_CHILD_ASSIGNMENT_H

#include <pcs/internal/parallel.h>
#include <pcs/shape_space/matching/Matching_energy.h>
#include <pcs/shape_space/matching/assign_whorls.h>
#include <pcs/shape_space/matching/linear_assignment.h>
#include <pcs/shape_space/model/Matched_branch.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace pcs {
namespace shape_space {

/// Children that are assigned at a time [count].
constexpr std::size_t most_children_at_once = 512;

/// The cost of two branches [-]; infinity and no match if they cost as much as unmatched.
struct Match_answer
{
  Match_answer(double c) : cost(c) {}
  Match_answer(const std::shared_ptr<const Matched_branch>& match)
    : cost(match ? match->cost : std::numeric_limits<double>::infinity()), branch(match)
  {
  }
  double cost;
  std::shared_ptr<const Matched_branch> branch;
};

/*!
  Assigns the children of two branches to each other.

  Children i and j of a pair save

      g_ij = c_ij + p_ij - u_i - u_j,

  with the cost c_ij of their subtrees, the cost p_ij of the difference of their attachments, and
  the costs u_i and u_j of unmatched subtrees; all [-]. The assignment of least total is found with
  lower bounds of c_ij. The bounds of assigned pairs are then replaced by exact costs, until all
  assigned pairs are exact.

  `Match`: `match(start_1, start_2)` returns the `Match_answer` of two children; called from several
  threads.
*/
template <class ConcurrencyTag, class Match>
class Child_assignment
{
public:
  using Children = Matching_energy::Children;

  /// Keeps references to all arguments but the last. `inherited`: the rotation with which children
  /// are matched.
  Child_assignment(const Matching_energy& energy,
                   const std::array<Children, 2>& children,
                   const Eigen::Matrix3d& inherited,
                   const Match& match,
                   double limit)
    : m_energy(energy),
      m_a(children[0]),
      m_b(children[1]),
      m_inherited(inherited),
      m_match(match),
      m_limit(limit)
  {
  }

  /// Adds the pairs of children and their gains; returns `false` if the cost is not below the
  /// limit. Very many children are assigned in batches, the heaviest first, so time and memory grow
  /// linearly with their number. Batches do not divide whorls.
  bool add_pairs(Matched_branch& result) const
  {
    const bool may_keep = m_energy.weights().do_keep_whorls && !m_energy.weights().is_published;
    std::array<Whorls, 2> groups;
    if (may_keep && !(groups[0] = find_whorls(m_a.s)).empty())
      groups[1] = find_whorls(m_b.s);
    const bool are_whorls = !groups[1].empty();
    if (std::max(m_a.s.size(), m_b.s.size()) <= most_children_at_once)
      return add_pairs_of({by_index(m_a), by_index(m_b)},
                          are_whorls ? &groups : nullptr,
                          m_limit,
                          result);
    if (!are_whorls)
      groups = {single_whorls(m_a.s.size()), single_whorls(m_b.s.size())};
    add_pairs_in_batches(groups, are_whorls, result);
    return result.cost < m_limit;
  }

private:
  static constexpr double unknown = -1; // cost that was not computed

  /// Some children of each branch, by their positions.
  using Chosen = std::array<std::vector<std::size_t>, 2>;

  void
  add_pairs_in_batches(std::array<Whorls, 2> groups, bool are_whorls, Matched_branch& result) const
  {
    sort_by_weight(m_a, groups[0]);
    sort_by_weight(m_b, groups[1]);
    std::array<Whorls, 2> open;
    std::array<std::size_t, 2> next = {0, 0};
    while (next[0] < groups[0].size() || next[1] < groups[1].size()) {
      for (std::size_t t = 0; t < 2; ++t) {
        // the lightest unmatched children are tried once more
        while (number_of_members(open[t]) > most_children_at_once)
          open[t].erase(open[t].begin());
        for (std::size_t n = 0; next[t] < groups[t].size() && n < most_children_at_once;
             ++next[t]) {
          n += groups[t][next[t]].size();
          open[t].push_back(groups[t][next[t]]);
        }
      }
      const std::array<Whorls, 2> whorls = {renumbered(open[0]), renumbered(open[1])};
      const std::size_t first = result.pairs.size();
      add_pairs_of({members_of(open[0]), members_of(open[1])},
                   are_whorls ? &whorls : nullptr,
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

  /// Assigns some children of both branches. `whorls`: by position in `chosen`, or null.
  bool add_pairs_of(const Chosen& chosen,
                    const std::array<Whorls, 2>* whorls,
                    double limit,
                    Matched_branch& result) const
  {
    const std::vector<std::size_t>&rows = chosen[0], &columns = chosen[1];
    const std::size_t n = rows.size(), m = columns.size();
    std::vector<double> gain(n * m);
    const double parent_length = m_energy.length(0, result.path_1);
    const auto rest = [&](std::size_t i, std::size_t j) {
      return m_energy.position_term(m_a.length[i],
                                    m_b.length[j],
                                    m_a.s[i],
                                    m_b.s[j],
                                    parent_length) -
             m_energy.single_term(m_a.weight[i]) - m_energy.single_term(m_b.weight[j]);
    };
    std::array<std::vector<std::size_t>, 2> starts;
    for (const std::size_t i : rows)
      starts[0].push_back(m_a.start[i]);
    for (const std::size_t j : columns)
      starts[1].push_back(m_b.start[j]);
    m_energy.least_costs(starts[0],
                         starts[1],
                         m_inherited,
                         [&](std::size_t r, std::size_t c, double least) {
                           gain[r * m + c] = least + rest(rows[r], columns[c]);
                         });
    const auto add = [&](auto& assignment) {
      return add_exact_pairs(chosen, rest, limit, gain, assignment, result);
    };
    if (whorls != nullptr) {
      Whorl_assignment assignment((*whorls)[0], (*whorls)[1], gain);
      return add(assignment);
    }
    Assignment assignment(n, m, gain);
    assignment.solve();
    return add(assignment);
  }

  /// Replaces the bounds of assigned pairs by exact costs until all of them are exact. Adds the
  /// pairs and their gains; returns `false` if the cost is not below `limit`. `gain`: the matrix
  /// that `assignment` refers to.
  template <class Rest, class Pairs>
  bool add_exact_pairs(const Chosen& chosen,
                       const Rest& rest,
                       double limit,
                       std::vector<double>& gain,
                       Pairs& assignment,
                       Matched_branch& result) const
  {
    const std::vector<std::size_t>&rows = chosen[0], &columns = chosen[1];
    const std::size_t n = rows.size(), m = columns.size();
    std::vector<Match_answer> exact(n * m, Match_answer(unknown));
    const auto match_pair = [&](std::size_t r, std::size_t c) {
      const std::size_t i = rows[r], j = columns[c];
      Match_answer& found = exact[r * m + c];
      found = m_match(m_a.start[i], m_b.start[j]);
      gain[r * m + c] = std::isfinite(found.cost) ? found.cost + rest(i, j) : 0;
    };
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
      keep_heaviest(chosen, partner, wanted);
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
  void keep_heaviest(const Chosen& chosen,
                     const std::vector<std::size_t>& partner,
                     std::vector<std::size_t>& wanted) const
  {
    constexpr std::size_t fewest = 16, part = 3;
    const std::size_t number = std::max(fewest, wanted.size() / part);
    if (wanted.size() <= number)
      return;
    const auto weight = [&](std::size_t r) {
      return m_a.weight[chosen[0][r]] + m_b.weight[chosen[1][partner[r]]];
    };
    std::stable_sort(wanted.begin(), wanted.end(), [&](std::size_t r, std::size_t s) {
      return weight(r) > weight(s);
    });
    wanted.resize(number);
  }

  const Matching_energy& m_energy;
  const Children &m_a, &m_b;
  const Eigen::Matrix3d& m_inherited;
  const Match& m_match;
  double m_limit;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_CHILD_ASSIGNMENT_H
