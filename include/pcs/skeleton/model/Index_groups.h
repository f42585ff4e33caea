// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What belongs to each of some groups: points to axes or nodes, children to parents.

#ifndef PCS_SKELETON_MODEL_INDEX_GROUPS_H
#define PCS_SKELETON_MODEL_INDEX_GROUPS_H

#include <pcs/skeleton/model/Scan.h>

#include <boost/range/iterator_range.hpp>

#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// The members of each group, in increasing order.
class Index_groups
{
public:
  /// `group_of_member` has the group of each member, or `none`. O(members + groups).
  Index_groups(std::size_t number_of_groups, const std::vector<Index>& group_of_member)
    : m_first(number_of_groups + 1, 0)
  {
    for (const Index g : group_of_member)
      if (g != none)
        ++m_first[g + 1];
    for (std::size_t g = 0; g < number_of_groups; ++g)
      m_first[g + 1] += m_first[g];
    m_members.resize(m_first.back());
    std::vector<Index> place(m_first.begin(), m_first.end() - 1);
    for (Index i = 0; i < group_of_member.size(); ++i)
      if (group_of_member[i] != none)
        m_members[place[group_of_member[i]]++] = i;
  }

  boost::iterator_range<const Index*> operator[](std::size_t group) const
  {
    return {m_members.data() + m_first[group], m_members.data() + m_first[group + 1]};
  }

private:
  std::vector<Index> m_first, m_members;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_INDEX_GROUPS_H
