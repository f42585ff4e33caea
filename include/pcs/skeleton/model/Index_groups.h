// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Members of groups in compressed rows: points of axes, children of parents.

#ifndef PCS_SKELETON_MODEL_INDEX_GROUPS_H
#define PCS_SKELETON_MODEL_INDEX_GROUPS_H

#include <pcs/internal/compress_rows.h>
#include <pcs/skeleton/model/Scan.h>

#include <boost/range/iterator_range.hpp>

#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Members of each group in increasing order.
class Index_groups
{
public:
  /// `group_of_member`: group of each member, or `none`. O(members + groups).
  Index_groups(std::size_t number_of_groups, const std::vector<Index>& group_of_member)
    : m_first(pcs::internal::compress_rows<Index>(
          number_of_groups,
          group_of_member.size(),
          [&](std::size_t i) { return std::size_t(group_of_member[i]); }, // `none` is left out
          [&](std::size_t n) { m_members.resize(n); },
          [&](std::size_t i, std::size_t k) { m_members[k] = static_cast<Index>(i); }))
  {
  }

  boost::iterator_range<const Index*> operator[](std::size_t group) const
  {
    return {m_members.data() + m_first[group], m_members.data() + m_first[group + 1]};
  }

private:
  std::vector<Index> m_members, m_first; // the initialization of `m_first` fills `m_members`
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_INDEX_GROUPS_H
