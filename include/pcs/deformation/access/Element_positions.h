// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Positions of the elements of a range, such as the vertex descriptors of a mesh.

#ifndef PCS_DEFORMATION_ACCESS_ELEMENT_POSITIONS_H
#define PCS_DEFORMATION_ACCESS_ELEMENT_POSITIONS_H

#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

template <class T, class = void>
struct Is_ordered : std::false_type
{
};
template <class T>
struct Is_ordered<T, std::void_t<decltype(std::declval<const T&>() < std::declval<const T&>())>>
  : std::is_copy_constructible<T>
{
};

template <class Range, class T, class = void>
struct Is_range_of : std::false_type
{
};
template <class Range, class T>
struct Is_range_of<Range,
                   T,
                   std::void_t<decltype(*std::begin(std::declval<const Range&>())),
                               decltype(std::end(std::declval<const Range&>()))>>
  : std::is_same<std::decay_t<decltype(*std::begin(std::declval<const Range&>()))>, T>
{
};

} // namespace internal

/// Finds the positions of elements with the same value in a range. `Element` has the operator `<`.
template <class Element>
class Element_positions
{
public:
  /// O(n log n)
  template <class Range>
  explicit Element_positions(const Range& range)
  {
    std::uint32_t position = 0;
    for (auto it = std::begin(range); it != std::end(range); ++it)
      m_sorted.emplace_back(*it, position++);
    std::stable_sort(m_sorted.begin(), m_sorted.end(), [](const Entry& a, const Entry& b) {
      return a.first < b.first;
    });
  }

  /// Returns the positions of all elements that equal one of `elements`. Throws `Invalid_input`,
  /// with a message that begins with `caller`, if there is none for one of them. O(m log n).
  template <class Elements>
  std::vector<std::uint32_t> find(const Elements& elements, const std::string& caller) const
  {
    std::vector<std::uint32_t> result;
    std::size_t number = 0;
    for (const Element& e : elements) {
      auto at = std::lower_bound(m_sorted.begin(),
                                 m_sorted.end(),
                                 e,
                                 [](const Entry& a, const Element& b) { return a.first < b; });
      if (at == m_sorted.end() || e < at->first)
        throw Invalid_input(caller + ": element " + std::to_string(number) +
                            " of the range of handle points is not an element of the points");
      for (; at != m_sorted.end() && !(e < at->first); ++at)
        result.push_back(at->second);
      ++number;
    }
    return result;
  }

private:
  using Entry = std::pair<Element, std::uint32_t>;
  std::vector<Entry> m_sorted;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_ELEMENT_POSITIONS_H
