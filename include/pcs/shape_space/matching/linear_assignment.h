// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Linear assignment with optional pairs: shortest augmenting paths.

#ifndef PCS_SHAPE_SPACE_MATCHING_LINEAR_ASSIGNMENT_H
#define PCS_SHAPE_SPACE_MATCHING_LINEAR_ASSIGNMENT_H

#include <pcs/shape_space/model/Rooted_tree.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace shape_space {

/*!
  Minimises the sum of `gain[i * m + j]` over pairs, each row and column at most once; rows and
  columns may stay single. Non-negative entries are never used.

  Shortest augmenting paths (Jonker, Volgenant 1987); O(n^2 m) at first. When the entries of pairs
  grow, only the rows and columns of these pairs are assigned again; all other prices stay valid.
  Ties are broken by the lowest index.
*/
class Assignment
{
public:
  /// `gain` is kept by reference and may change between calls, see `raise()`. `prices`: of
  /// the columns in a similar problem, none positive, to save time; may be empty.
  Assignment(std::size_t n,
             std::size_t m,
             const std::vector<double>& gain,
             const std::vector<double>& prices = std::vector<double>())
    : m_gain(gain), m_rows(n, m), m_columns(m, 1)
  {
    if (!prices.empty())
      m_columns.price = prices;
    std::vector<std::size_t> best(n, none);
    for (std::size_t r = 0; r < n; ++r)
      for (std::size_t c = 0; c < m; ++c)
        if (const double g = gain[r * m + c]; g < 0 && g - m_columns.price[c] < m_rows.price[r]) {
          m_rows.price[r] = g - m_columns.price[c];
          best[r] = c;
        }
    for (const double p : m_rows.price)
      m_bound += p;
    for (const double p : m_columns.price)
      m_bound += p;
    for (std::size_t r = 0; r < n; ++r)
      if (best[r] != none && m_columns.partner[best[r]] == none) {
        m_columns.partner[best[r]] = r;
        m_rows.partner[r] = best[r];
      }
  }

  /// Returns a lower bound for the cost of all pairs; after `solve()` their cost.
  double bound() const { return m_bound; }

  /// Finds the pairs of least cost; returns `false` as soon as their cost is known to exceed
  /// `most`.
  bool solve(double most = std::numeric_limits<double>::infinity())
  {
    for (std::size_t r = 0; r < m_rows.partner.size() && m_bound <= most; ++r)
      augment(m_rows, m_columns, r);
    for (std::size_t c = 0; c < m_columns.partner.size() && m_bound <= most; ++c)
      augment(m_columns, m_rows, c);
    return m_bound <= most;
  }

  const std::vector<double>& prices() const { return m_columns.price; }
  /// Returns the column of each row, or `none`.
  const std::vector<std::size_t>& columns() const { return m_rows.partner; }

  /// Updates the pairs after the entries of the pairs of these rows grew, and no others changed.
  void raise(const std::vector<std::size_t>& rows)
  {
    std::vector<std::size_t> columns;
    for (const std::size_t r : rows) {
      columns.push_back(m_rows.partner[r]);
      m_columns.partner[columns.back()] = none;
      m_rows.partner[r] = none;
    }
    for (const std::size_t r : rows)
      augment(m_rows, m_columns, r);
    for (const std::size_t c : columns)
      augment(m_columns, m_rows, c);
  }

private:
  struct Reached
  {
    std::size_t row, column; ///< column through which it was reached
    double distance;
  };
  struct Side
  {
    Side(std::size_t n, std::size_t step) : price(n, 0), partner(n, none), stride(step) {}
    std::vector<double> price; ///< dual
    std::vector<std::size_t> partner;
    std::size_t stride; ///< in the table
  };

  /// Result of a search: the free vertex of the other side that ends the path, or else the row to
  /// leave single at least cost.
  struct Path_end
  {
    std::size_t column, single_row;
    double distance; ///< reduced cost of the path
  };

  /// Assigns row `r`, or leaves it or another row of its side single. Single rows have the price 0.
  void augment(Side& own, Side& other, std::size_t r)
  {
    if (own.partner[r] != none || !(own.price[r] < 0))
      return;
    const Path_end end = find_path(own, other, r);
    m_bound += end.distance;
    update_prices(own, other, end.distance);
    flip_path(own, other, r, end);
  }

  /// Grows the shortest-path tree from row `r` until it reaches a free vertex, or until it is
  /// cheapest to leave a row of the tree single.
  Path_end find_path(const Side& own, const Side& other, std::size_t r)
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::size_t m = other.price.size(), stride = other.stride;
    m_least.assign(m, infinity);
    m_previous.resize(m);
    m_open = other.price; // -inf: in the tree
    double *const least = m_least.data(), *const open = m_open.data();
    std::size_t* const previous = m_previous.data();
    m_tree.assign(1, {r, none, 0});
    double single = -own.price[r]; // least reduced cost of leaving a row of the tree single
    Path_end end{none, r, 0};
    for (;;) {
      const std::size_t row = m_tree.back().row;
      const double* const gain = m_gain.data() + row * own.stride;
      const double begin = end.distance - own.price[row];
      double nearest = single;
      std::size_t next = none;
      for (std::size_t j = 0; j < m; ++j) {
        const double g = gain[j * stride];
        const double reduced = begin + g - open[j];
        if (g < 0 && reduced < least[j]) {
          least[j] = reduced;
          previous[j] = row;
        }
        if (least[j] < nearest && open[j] > -infinity) {
          nearest = least[j];
          next = j;
        }
      }
      end.distance = std::max(end.distance, nearest);
      if (next == none)
        return end;
      if (other.partner[next] == none) {
        end.column = next;
        return end;
      }
      open[next] = -infinity;
      m_tree.push_back({other.partner[next], next, end.distance});
      const double alone = end.distance - own.price[m_tree.back().row];
      if (alone < single) {
        single = alone;
        end.single_row = m_tree.back().row;
      }
    }
  }

  void update_prices(Side& own, Side& other, double distance) const
  {
    for (const Reached& t : m_tree) {
      own.price[t.row] = std::min(0.0, own.price[t.row] + (distance - t.distance));
      if (t.column != none)
        other.price[t.column] -= distance - t.distance;
    }
  }

  /// Exchanges matched and unmatched pairs along the path from row `r`.
  void flip_path(Side& own, Side& other, std::size_t r, const Path_end& end) const
  {
    std::size_t column = end.column;
    if (column == none) {
      own.price[end.single_row] = 0; // it is 0 up to rounding
      if (end.single_row == r)
        return;
      column = own.partner[end.single_row];
      own.partner[end.single_row] = none;
    }
    for (;;) {
      const std::size_t i = m_previous[column];
      const std::size_t freed = own.partner[i];
      other.partner[column] = i;
      own.partner[i] = column;
      if (i == r)
        break;
      column = freed;
    }
  }

  const std::vector<double>& m_gain;
  Side m_rows, m_columns;
  double m_bound = 0; // sum of all prices
  std::vector<double> m_least, m_open;
  std::vector<std::size_t> m_previous;
  std::vector<Reached> m_tree;
};

/// Returns the column of each row, or `none`.
inline std::vector<std::size_t>
assign_rows(std::size_t n, std::size_t m, const std::vector<double>& gain)
{
  Assignment assignment(n, m, gain);
  assignment.solve();
  return assignment.columns();
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_LINEAR_ASSIGNMENT_H
