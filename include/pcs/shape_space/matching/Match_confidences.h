// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Confidence of matched branches: the energy of a match compared with that of its alternatives.

#ifndef PCS_SHAPE_SPACE_MATCHING_MATCH_CONFIDENCES_H
#define PCS_SHAPE_SPACE_MATCHING_MATCH_CONFIDENCES_H

#include <pcs/shape_space/matching/Branch_matching.h>
#include <pcs/shape_space/matching/compare_branches.h>
#include <pcs/shape_space/matching/linear_assignment.h>
#include <pcs/shape_space/model/Matched_branch.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Computes the confidences of a matching [-]. For children `i` and `j` of matched branches, let `D`
  be the least increase of the energy of all children if `i` and `j` must not be matched, so that
  they have other partners, or none. With the energy `C_ij + P_ij` of the pair, as in
  `Matching_energy`,

      own = D / (C_ij + P_ij + D),   confidence = min(own, confidence of the parents).

  It is in [0, 1]: 0 if another matching is as good, 0.5 if the alternative costs twice as much as
  the pair, and 1 if the pair costs nothing. A pair of wrong parents has wrong children, so the
  confidence does not increase towards the tips. That of the trunks is 1.

  Costs of alternatives are known from the search, or lower bounds; those that an alternative
  contains are computed with one trial per pair of branches. Of more than 512 children, alternatives
  are searched among 512 matches of similar weight. An alternative costs one augmenting path, so
  the time is a fraction of that of the matching.
*/
template <class ConcurrencyTag>
class Match_confidences
{
public:
  using Matching = Branch_matching<ConcurrencyTag>;

  /// `matching`: with the rotation of tree 2 and the memory of the search.
  explicit Match_confidences(Matching& matching) : m_matching(matching) {}

  /// Returns the confidences of the branches of a result of the search, by their first node in tree
  /// 1; that of the trunk by the root.
  std::unordered_map<std::size_t, double> run(const Matched_branch& trunk)
  {
    m_result.clear();
    m_result[0] = 1;
    add_children(trunk, m_matching.rotation(), 1);
    return std::move(m_result);
  }

private:
  using Pair = Matched_branch::Pair;

  static constexpr std::size_t most_at_once = 512; // matches whose alternatives are searched
  static constexpr int most_rounds = 8;            // of exact costs of an alternative

  /// The children of two branches that are assigned together: rows and columns of a table of gains,
  /// which are the costs of pairs minus those of single branches, and whether these are exact.
  struct Table
  {
    std::vector<std::size_t> rows, columns;
    std::vector<double> gain;
    std::vector<char> is_exact;
    double& at(std::size_t r, std::size_t c) { return gain[r * columns.size() + c]; }
  };

  void
  add_children(const Matched_branch& parent, const Eigen::Matrix3d& inherited, double confidence)
  {
    if (parent.pairs.empty())
      return;
    const Matching_energy& energy = m_matching.energy();
    const Compared_branches both =
        compare_branches(energy,
                         first_trial(energy, parent.path_1, parent.path_2, inherited),
                         inherited);
    m_parent_length = energy.length(0, parent.path_1);
    const std::size_t n = both.children[0].s.size(), m = both.children[1].s.size();
    std::vector<double> own(n, 0);
    if (std::max(n, m) <= most_at_once) {
      Table table;
      for (std::size_t i = 0; i < n; ++i)
        table.rows.push_back(i);
      for (std::size_t j = 0; j < m; ++j)
        table.columns.push_back(j);
      find_own(both, parent.pairs, table, own);
    } else
      find_own_in_groups(both, parent.pairs, own);
    for (const Pair& p : parent.pairs) {
      const std::size_t start_1 = both.children[0].start[p.child_1];
      const double least = std::min(own[p.child_1], confidence);
      m_result[start_1] = least;
      add_children(*p.branch, m_matching.inherited_rotation(both.rotation), least);
    }
  }

  void find_own_in_groups(const Compared_branches& both,
                          std::vector<Pair> pairs,
                          std::vector<double>& own) const
  {
    const std::vector<double>& weight = both.children[0].weight;
    std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& x, const Pair& y) {
      return weight[x.child_1] > weight[y.child_1];
    });
    for (std::size_t begin = 0; begin < pairs.size(); begin += most_at_once) {
      const auto first = pairs.begin() + static_cast<std::ptrdiff_t>(begin);
      const std::vector<Pair> group(
          first,
          first + static_cast<std::ptrdiff_t>(std::min(most_at_once, pairs.size() - begin)));
      Table table;
      for (const Pair& p : group) {
        table.rows.push_back(p.child_1);
        table.columns.push_back(p.child_2);
      }
      find_own(both, group, table, own);
    }
  }

  /// Returns the cost of the position of two children minus their costs when unmatched. [-]
  double rest(const Compared_branches& both, std::size_t i, std::size_t j) const
  {
    const Matching_energy& energy = m_matching.energy();
    const auto &a = both.children[0], &b = both.children[1];
    return energy.position_term(a.length[i], b.length[j], a.s[i], b.s[j], m_parent_length) -
           energy.single_term(a.weight[i]) - energy.single_term(b.weight[j]);
  }

  void find_own(const Compared_branches& both,
                const std::vector<Pair>& pairs,
                Table& table,
                std::vector<double>& own) const
  {
    const auto &a = both.children[0], &b = both.children[1];
    const std::size_t n = table.rows.size(), m = table.columns.size();
    table.gain.resize(n * m);
    table.is_exact.assign(n * m, 0);
    for (std::size_t r = 0; r < n; ++r)
      for (std::size_t c = 0; c < m; ++c)
        table.at(r, c) = m_matching.known_cost(a.start[table.rows[r]],
                                               b.start[table.columns[c]],
                                               both.rotation) +
                         rest(both, table.rows[r], table.columns[c]);
    std::vector<std::size_t> row(a.s.size(), none), column(b.s.size(), none);
    for (std::size_t r = 0; r < n; ++r)
      row[table.rows[r]] = r;
    for (std::size_t c = 0; c < m; ++c)
      column[table.columns[c]] = c;
    for (const Pair& p : pairs) {
      const std::size_t r = row[p.child_1], c = column[p.child_2];
      table.at(r, c) = p.branch->cost + rest(both, p.child_1, p.child_2);
      table.is_exact[r * m + c] = 1;
    }
    Assignment assignment(n, m, table.gain);
    assignment.solve();
    for (const Pair& p : pairs) {
      const std::size_t r = row[p.child_1], c = column[p.child_2];
      if (assignment.columns()[r] != c)
        continue; // another assignment is as good
      const Matching_energy& energy = m_matching.energy();
      const double gain = table.at(r, c);
      const double cost = std::max(0.0,
                                   gain + energy.single_term(a.weight[p.child_1]) +
                                       energy.single_term(b.weight[p.child_2]));
      const double more = increase_without(both, assignment, r, c, table);
      own[p.child_1] = more > 0 ? more / (more + cost) : 0;
    }
  }

  /// Returns the increase of the energy if row `r` and column `c` must not be matched. [-]
  double increase_without(const Compared_branches& both,
                          const Assignment& assignment,
                          std::size_t r,
                          std::size_t c,
                          Table& table) const
  {
    const double gain = table.at(r, c);
    table.at(r, c) = 0; // it is not used
    Assignment other = assignment;
    other.raise({r});
    std::vector<std::size_t> raised;
    for (int round = 0; round < most_rounds; ++round) {
      raised.clear();
      for (std::size_t i = 0; i < table.rows.size(); ++i)
        if (const std::size_t j = other.columns()[i]; j != none && set_exact(both, i, j, table))
          raised.push_back(i);
      if (raised.empty())
        break;
      other.raise(raised);
    }
    table.at(r, c) = gain;
    return other.bound() - assignment.bound();
  }

  /// Replaces a lower bound by the exact cost; returns whether this is higher.
  bool set_exact(const Compared_branches& both, std::size_t r, std::size_t c, Table& table) const
  {
    char& is_exact = table.is_exact[r * table.columns.size() + c];
    if (is_exact)
      return false;
    is_exact = 1;
    const std::size_t i = table.rows[r], j = table.columns[c];
    const double exact = m_matching.quick_match(both.children[0].start[i],
                                                both.children[1].start[j],
                                                both.rotation) +
                         rest(both, i, j);
    if (!(exact > table.at(r, c)))
      return false;
    table.at(r, c) = exact;
    return true;
  }

  Matching& m_matching;
  double m_parent_length = 0;
  std::unordered_map<std::size_t, double> m_result;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_MATCH_CONFIDENCES_H
