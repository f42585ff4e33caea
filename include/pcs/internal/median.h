// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Medians and other order statistics by selection, which reorders the values.

#ifndef PCS_INTERNAL_MEDIAN_H
#define PCS_INTERNAL_MEDIAN_H

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace pcs {
namespace internal {

/// Returns the value of rank `rank`, counted from 0 in ascending order. The rank must be smaller
/// than the number of values. O(values).
template <class Iterator>
typename std::iterator_traits<Iterator>::value_type
value_of_rank(Iterator first, Iterator last, std::size_t rank)
{
  const Iterator at =
      first + static_cast<typename std::iterator_traits<Iterator>::difference_type>(rank);
  std::nth_element(first, at, last);
  return *at;
}

template <class T>
T value_of_rank(std::vector<T>& values, std::size_t rank)
{
  return internal::value_of_rank(values.begin(), values.end(), rank);
}

/// Returns the median. For an even number of values, it is the lower of the two middle ones; for no
/// values, it is 0.
template <class T>
T lower_median(std::vector<T>& values)
{
  return values.empty() ? T(0) : internal::value_of_rank(values, (values.size() - 1) / 2);
}

/// Returns the median. For an even number of values, it is the upper of the two middle ones; for no
/// values, it is 0.
template <class Iterator>
typename std::iterator_traits<Iterator>::value_type upper_median(Iterator first, Iterator last)
{
  using T = typename std::iterator_traits<Iterator>::value_type;
  const auto n = static_cast<std::size_t>(last - first);
  return n == 0 ? T(0) : internal::value_of_rank(first, last, n / 2);
}

template <class T>
T upper_median(std::vector<T>& values)
{
  return internal::upper_median(values.begin(), values.end());
}

/// Returns the median. For an even number of values, it is the mean of the two middle ones; for no
/// values, it is 0.
template <class T>
T mean_median(std::vector<T>& values)
{
  if (values.empty())
    return T(0);
  const std::size_t n = values.size();
  const T lower = internal::value_of_rank(values, (n - 1) / 2);
  return T(0.5) * (lower + internal::value_of_rank(values, n / 2));
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_MEDIAN_H
