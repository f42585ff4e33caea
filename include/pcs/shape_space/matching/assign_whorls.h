// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Whorls: branches that begin at the same place of their parent, and assignments that keep them.

#ifndef PCS_SHAPE_SPACE_MATCHING_ASSIGN_WHORLS_H
#define PCS_SHAPE_SPACE_MATCHING_ASSIGN_WHORLS_H

#include <pcs/shape_space/matching/linear_assignment.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Positions of children that belong together, in ascending order of their attachments.
using Whorls = std::vector<std::vector<std::size_t>>;

namespace internal {

/// Returns groups of children whose neighbours are at most `gap` apart. `order`: by `s`.
inline Whorls
groups_within(const std::vector<double>& s, const std::vector<std::size_t>& order, double gap)
{
  Whorls whorls;
  for (std::size_t k = 0; k < order.size(); ++k)
    if (k > 0 && s[order[k]] - s[order[k - 1]] <= gap)
      whorls.back().push_back(order[k]);
    else
      whorls.push_back({order[k]});
  return whorls;
}

/// Returns whether at least four groups have the same size, two or more, and these groups have
/// at least 60 % of all `n` children.
inline bool are_whorls(const Whorls& groups, std::size_t n)
{
  constexpr double member_share = 0.6;
  constexpr std::size_t fewest_whorls = 4;
  std::vector<std::size_t> number_of_size(n + 1, 0);
  for (const std::vector<std::size_t>& group : groups)
    ++number_of_size[group.size()];
  for (std::size_t size = 2; size <= n; ++size)
    if (number_of_size[size] >= fewest_whorls &&
        static_cast<double>(size * number_of_size[size]) >= member_share * static_cast<double>(n))
      return true;
  return false;
}

} // namespace internal

/*!
  Returns the whorls of a parent whose branches are arranged in pairs or whorls, such as opposite
  branches. Whorls of one branch are possible. Empty if the arrangement is another one. `s`: the
  attachments [-].

  Neighbours in a whorl are near each other, and whorls are far apart. The distances of neighbours
  therefore fall into two classes, and each distance of the second class is at least twice as large
  as those of the first one. The parent has this arrangement if at least four whorls have the same
  size, and these whorls have 60 % of all branches. Of several divisions, the one with the largest
  ratio is used. Random attachments rarely meet these conditions.
*/
inline Whorls find_whorls(const std::vector<double>& s)
{
  constexpr double least_ratio = 2, least_gap_share = 0.01;
  const std::size_t n = s.size();
  if (n < 8)
    return {};
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return s[i] < s[j];
  });
  // distances below a hundredth of their mean are equal
  const double least_gap =
      least_gap_share * (s[order.back()] - s[order.front()]) / static_cast<double>(n - 1);
  if (!(least_gap > 0))
    return {};
  std::vector<double> gaps;
  for (std::size_t k = 1; k < n; ++k)
    gaps.push_back(std::max(least_gap, s[order[k]] - s[order[k - 1]]));
  std::sort(gaps.begin(), gaps.end());
  Whorls best;
  double best_ratio = 0;
  for (std::size_t k = 1; k < gaps.size(); ++k) {
    const double ratio = gaps[k] / gaps[k - 1];
    if (ratio < least_ratio || !(ratio > best_ratio))
      continue;
    Whorls groups = internal::groups_within(s, order, gaps[k - 1]);
    if (internal::are_whorls(groups, n)) {
      best = std::move(groups);
      best_ratio = ratio;
    }
  }
  return best;
}

/// Returns `n` whorls of one branch.
inline Whorls single_whorls(std::size_t n)
{
  Whorls whorls;
  for (std::size_t i = 0; i < n; ++i)
    whorls.push_back({i});
  return whorls;
}

/// Returns the members of all whorls, in this order.
inline std::vector<std::size_t> members_of(const Whorls& whorls)
{
  std::vector<std::size_t> members;
  for (const std::vector<std::size_t>& whorl : whorls)
    members.insert(members.end(), whorl.begin(), whorl.end());
  return members;
}

inline std::size_t number_of_members(const Whorls& whorls)
{
  std::size_t n = 0;
  for (const std::vector<std::size_t>& whorl : whorls)
    n += whorl.size();
  return n;
}

/// Returns whorls with the positions in `members_of(whorls)` instead of the members.
inline Whorls renumbered(Whorls whorls)
{
  std::size_t next = 0;
  for (std::vector<std::size_t>& whorl : whorls)
    for (std::size_t& member : whorl)
      member = next++;
  return whorls;
}

/// Erases the whorl of a member, if there is one.
inline void erase_whorl(Whorls& whorls, std::size_t member)
{
  const auto has_member = [&](const std::vector<std::size_t>& whorl) {
    return std::find(whorl.begin(), whorl.end(), member) != whorl.end();
  };
  whorls.erase(std::remove_if(whorls.begin(), whorls.end(), has_member), whorls.end());
}

/*!
  Minimises the sum of `gain[i * m + j]` over pairs, where all partners of the members of a whorl
  are members of one whorl. Non-negative entries are never used.

  The gain of two whorls is that of the best assignment of their members, and whorls are assigned
  like branches. Entries may be lower bounds: those of pairs that are assigned are replaced by exact
  values until all pairs are exact, so the result is the best one. O(w^3) for w whorls and round.
*/
class Whorl_assignment
{
public:
  /// `gain` has a row for each branch of `rows`, and a column for each one of `columns`; it is kept
  /// by reference.
  Whorl_assignment(const Whorls& rows, const Whorls& columns, std::vector<double>& gain)
    : m_rows(rows), m_columns(columns), m_gain(gain)
  {
    for (const std::vector<std::size_t>& whorl : columns)
      m_number_of_columns += whorl.size();
    m_whorl_gain.reserve(rows.size() * columns.size());
    for (std::size_t g = 0; g < rows.size(); ++g)
      for (std::size_t h = 0; h < columns.size(); ++h)
        m_whorl_gain.push_back(gain_of(g, h));
    for (const std::vector<std::size_t>& whorl : rows)
      m_partner.resize(m_partner.size() + whorl.size(), none);
    m_whorl_of_row.resize(m_partner.size());
    for (std::size_t g = 0; g < rows.size(); ++g)
      for (const std::size_t i : rows[g])
        m_whorl_of_row[i] = g;
    assign();
  }

  /// Returns the column of each row, or `none`.
  const std::vector<std::size_t>& columns() const { return m_partner; }

  /// Updates the pairs after entries of the pairs of `rows` grew, and no others changed.
  void raise(const std::vector<std::size_t>& rows)
  {
    for (const std::size_t r : rows) {
      const std::size_t g = m_whorl_of_row[r], h = m_whorl_partner[g];
      m_whorl_gain[g * m_columns.size() + h] = gain_of(g, h);
    }
    assign();
  }

private:
  /// Returns the columns, by position in whorl `h`, of the members of whorl `g`.
  std::vector<std::size_t> members_of(std::size_t g, std::size_t h) const
  {
    std::vector<double> gain;
    for (const std::size_t i : m_rows[g])
      for (const std::size_t j : m_columns[h])
        gain.push_back(m_gain[i * m_number_of_columns + j]);
    return assign_rows(m_rows[g].size(), m_columns[h].size(), gain);
  }

  double gain_of(std::size_t g, std::size_t h) const
  {
    const std::vector<std::size_t> partner = members_of(g, h);
    double sum = 0;
    for (std::size_t k = 0; k < partner.size(); ++k)
      if (partner[k] != none)
        sum += m_gain[m_rows[g][k] * m_number_of_columns + m_columns[h][partner[k]]];
    return sum;
  }

  void assign()
  {
    m_whorl_partner = assign_rows(m_rows.size(), m_columns.size(), m_whorl_gain);
    std::fill(m_partner.begin(), m_partner.end(), none);
    for (std::size_t g = 0; g < m_rows.size(); ++g)
      if (const std::size_t h = m_whorl_partner[g]; h != none) {
        const std::vector<std::size_t> partner = members_of(g, h);
        for (std::size_t k = 0; k < partner.size(); ++k)
          if (partner[k] != none)
            m_partner[m_rows[g][k]] = m_columns[h][partner[k]];
      }
  }

  const Whorls &m_rows, &m_columns;
  std::vector<double>& m_gain;
  std::size_t m_number_of_columns = 0;
  std::vector<double> m_whorl_gain;
  std::vector<std::size_t> m_whorl_of_row, m_whorl_partner, m_partner;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_ASSIGN_WHORLS_H
