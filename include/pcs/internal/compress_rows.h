// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compressed rows (CSR) by counting: entries of a graph or of groups, sorted by row.

#ifndef PCS_INTERNAL_COMPRESS_ROWS_H
#define PCS_INTERNAL_COMPRESS_ROWS_H

#include <cstddef>
#include <vector>

namespace pcs {
namespace internal {

/*!
  Sorts entries into the rows of one array: row `r` has the positions `[first[r], first[r + 1])`.
  Entries of a row keep their order.

  \param number_of_rows the number of rows
  \param number_of_entries entries are numbered from 0
  \param row_of `row_of(k)` is the row of entry `k`; entries with a value `>= number_of_rows` are
      omitted
  \param resize `resize(n)` is called once with the number of remaining entries
  \param put `put(k, position)` stores entry `k`
  \return `first`, with `number_of_rows + 1` elements

  O(rows + entries).
*/
template <class Size, class RowOf, class Resize, class Put>
std::vector<Size> compress_rows(std::size_t number_of_rows,
                                std::size_t number_of_entries,
                                const RowOf& row_of,
                                const Resize& resize,
                                const Put& put)
{
  std::vector<Size> first(number_of_rows + 1, 0);
  for (std::size_t k = 0; k < number_of_entries; ++k)
    if (row_of(k) < number_of_rows)
      ++first[row_of(k) + 1];
  for (std::size_t r = 0; r < number_of_rows; ++r)
    first[r + 1] += first[r];
  resize(static_cast<std::size_t>(first.back()));
  std::vector<Size> next(first.begin(), first.end() - 1);
  for (std::size_t k = 0; k < number_of_entries; ++k)
    if (row_of(k) < number_of_rows)
      put(k, static_cast<std::size_t>(next[row_of(k)]++));
  return first;
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_COMPRESS_ROWS_H
