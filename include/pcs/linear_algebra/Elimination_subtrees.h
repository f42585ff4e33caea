// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Subtrees of an elimination tree that can be processed in parallel, and the supernodes above them.

#ifndef PCS_LINEAR_ALGEBRA_ELIMINATION_SUBTREES_H
#define PCS_LINEAR_ALGEBRA_ELIMINATION_SUBTREES_H

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace linear_algebra {

/*!
  Disjoint subtrees of the supernodes of a `Cholesky_pattern`, each with at most a small fraction of
  the values. The subtrees, and thus sums over them, do not depend on the number of threads.

  The contributions of a subtree to rows above it are accumulated separately. For this purpose, each
  subtree has entries of its own in the work array of a solve, after the entries of the unknowns.
  They represent the rows below the root of the subtree, which are all rows above the subtree to
  which its supernodes contribute.
*/
class Elimination_subtrees
{
public:
  struct Subtree
  {
    std::uint32_t begin, end; ///< supernodes of the subtree, the root last
    std::size_t first_place;  ///< index of the entries for the rows below the root
    std::size_t scratch;      ///< index of the temporary entries for the rows below one supernode
    std::size_t first_above;  ///< index in `above` of the rows below the root
  };

  std::vector<Subtree> subtree;
  std::vector<std::uint32_t> top; ///< the other supernodes, increasing
  /// Rows of the pattern, where rows above a subtree are replaced by its entries; empty if there
  /// are no subtrees.
  std::vector<std::uint32_t> row;
  std::vector<std::uint32_t> above; ///< the rows below the roots of all subtrees
  std::size_t number_of_places = 0; ///< size of the work array

  /// Smaller factors are solved faster without tasks. [values]
  static constexpr std::size_t smallest_divided_factor = 400000;

  /// \param pattern complete except for its subtrees
  template <class Pattern>
  void find(const Pattern& pattern)
  {
    const std::size_t m = pattern.number_of_supernodes();
    if (pattern.number_of_values() >= smallest_divided_factor &&
        pattern.size() <= largest_divided_size)
      divide(pattern);
    number_of_places = pattern.size() + pattern.largest_number_of_rows_below;
    std::uint32_t next = 0;
    const auto add_top = [&](std::uint32_t end) {
      for (; next < end; ++next)
        top.push_back(next);
    };
    for (Subtree& t : subtree) {
      add_top(t.begin);
      next = t.end;
      t.first_place = number_of_places;
      t.scratch = t.first_place + pattern.number_of_rows_below(t.end - 1);
      t.first_above = above.size();
      above.insert(above.end(),
                   pattern.row.begin() + static_cast<std::ptrdiff_t>(pattern.first_row[t.end - 1]),
                   pattern.row.begin() + static_cast<std::ptrdiff_t>(pattern.first_row[t.end]));
      number_of_places = t.scratch;
      for (std::size_t s = t.begin; s < t.end; ++s)
        number_of_places = std::max(number_of_places, t.scratch + pattern.number_of_rows_below(s));
    }
    add_top(static_cast<std::uint32_t>(m));
    if (!subtree.empty())
      place_rows(pattern);
  }

private:
  /// Half the range of `row`; the other half is reserved for the entries of the subtrees.
  static constexpr std::size_t largest_divided_size = std::size_t(1) << 31;
  /// Each subtree contains at most the total number of values divided by this number.
  static constexpr std::size_t smallest_number_of_shares = 16;

  /// Descends from the roots until the remaining subtrees are small enough.
  template <class Pattern>
  void divide(const Pattern& pattern)
  {
    const std::size_t m = pattern.number_of_supernodes();
    std::vector<std::uint32_t> begin(m); // first descendant: in postorder a subtree is a range
    for (std::uint32_t s = 0; s < m; ++s)
      begin[s] = s;
    for (std::size_t s = 0; s < m; ++s)
      if (pattern.parent[s] != Pattern::none)
        begin[pattern.parent[s]] = std::min(begin[pattern.parent[s]], begin[s]);
    const std::size_t most = pattern.number_of_values() / smallest_number_of_shares;
    for (std::size_t end = m; end > 0;) {
      const std::size_t values = pattern.first_value[end] - pattern.first_value[begin[end - 1]];
      if (values > most) {
        --end; // its root belongs to `top`
        continue;
      }
      subtree.push_back({begin[end - 1], static_cast<std::uint32_t>(end), 0, 0, 0});
      end = begin[end - 1];
    }
    std::reverse(subtree.begin(), subtree.end());
  }

  template <class Pattern>
  void place_rows(const Pattern& pattern)
  {
    row = pattern.row;
    for (const Subtree& t : subtree) {
      const std::uint32_t end = pattern.first[t.end];
      const std::uint32_t* below = pattern.row.data() + pattern.first_row[t.end - 1];
      for (std::size_t s = t.begin; s < t.end; ++s) {
        std::size_t at = 0;
        for (std::size_t r = pattern.first_row[s]; r < pattern.first_row[s + 1]; ++r) {
          if (row[r] < end)
            continue;
          while (below[at] != row[r])
            ++at;
          row[r] = static_cast<std::uint32_t>(t.first_place + at);
        }
      }
    }
  }
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_ELIMINATION_SUBTREES_H
