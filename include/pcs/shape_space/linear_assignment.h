// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Assignment of rows to columns at least cost, where leaving both alone is free.

#ifndef PCS_SHAPE_SPACE_LINEAR_ASSIGNMENT_H
#define PCS_SHAPE_SPACE_LINEAR_ASSIGNMENT_H

#include <pcs/shape_space/Rooted_tree.h>

#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Minimises the sum of `gain[i * m + j]` over pairs, each row and column at most once; rows and columns may stay single.
  Entries that are not negative are never used. Returns the column of each row, or `none`.
  Shortest augmenting paths (Jonker, Volgenant 1987); O(n^2 m). Ties: the lowest index first.
*/
inline std::vector<std::size_t>
assign_rows(std::size_t n, std::size_t m, const std::vector<double>& gain)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> u(n, 0), v(m, 0), minimum(m);
  std::vector<std::size_t> row_of(m, none), column_of(n, none), previous_row(m);
  std::vector<char> is_used(m);
  std::vector<std::size_t> rows, columns;
  for (std::size_t r = 0; r < n; ++r) {
    std::fill(minimum.begin(), minimum.end(), infinity);
    std::fill(is_used.begin(), is_used.end(), 0);
    rows.assign(1, r);
    columns.clear();
    double single = -u[r]; // least reduced cost of leaving a row of the tree single
    std::size_t single_row = r, row = r, end_column = none;
    for (;;) {
      double delta = single;
      std::size_t next = none;
      for (std::size_t j = 0; j < m; ++j)
        if (!is_used[j]) {
          const double g = gain[row * m + j];
          if (g < 0) {
            const double reduced = g - u[row] - v[j];
            if (reduced < minimum[j]) {
              minimum[j] = reduced;
              previous_row[j] = row;
            }
          }
          if (minimum[j] < delta) {
            delta = minimum[j];
            next = j;
          }
        }
      for (const std::size_t i : rows)
        u[i] += delta;
      for (const std::size_t j : columns)
        v[j] -= delta;
      for (std::size_t j = 0; j < m; ++j)
        if (!is_used[j])
          minimum[j] -= delta;
      single -= delta;
      if (next == none)
        break;
      if (row_of[next] == none) {
        end_column = next;
        break;
      }
      is_used[next] = 1;
      columns.push_back(next);
      row = row_of[next];
      rows.push_back(row);
      if (-u[row] < single) {
        single = -u[row];
        single_row = row;
      }
    }
    // flip the path
    std::size_t column = end_column;
    if (column == none) {
      if (single_row == r)
        continue;
      column = column_of[single_row];
      column_of[single_row] = none;
    }
    for (;;) {
      const std::size_t i = previous_row[column];
      const std::size_t freed = column_of[i];
      row_of[column] = i;
      column_of[i] = column;
      if (i == r)
        break;
      column = freed;
    }
  }
  return column_of;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_LINEAR_ASSIGNMENT_H
