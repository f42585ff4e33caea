// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pattern of a sparse Cholesky factor: elimination order and tree, supernodes and their rows.

#ifndef PCS_LINEAR_ALGEBRA_CHOLESKY_PATTERN_H
#define PCS_LINEAR_ALGEBRA_CHOLESKY_PATTERN_H

#include <pcs/internal/progress.h>
#include <pcs/linear_algebra/Elimination_subtrees.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace linear_algebra {

/*!
  The symbolic half of a Cholesky factorisation. Adjacent columns of the factor with (almost) the
  same rows form one dense *panel*, a supernode: its own `w` rows first, then `m` rows below, which
  belong to its ancestors. The entries below the diagonal are stored panel by panel, column by
  column: `w (w - 1) / 2 + w m` values each.

  Order: minimum degree (Amestoy, Davis, Duff 1996) or a given order, then postorder of the
  elimination tree (Liu 1990). Column counts: Gilbert, Ng, Peyton 1994. Except for the order, the
  time is linear in the entries of the matrix and in the rows of the supernodes.
*/
class Cholesky_pattern
{
public:
  using Matrix = Eigen::SparseMatrix<double>;
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  std::vector<std::uint32_t>
      new_of_old;                   ///< index of each row of the matrix in the order of elimination
  std::vector<std::uint32_t> first; ///< first column of each supernode, and the end
  std::vector<std::uint32_t> parent;    ///< parent of each supernode, or `none`
  std::vector<std::size_t> first_row;   ///< of each supernode in `row`, and the end
  std::vector<std::uint32_t> row;       ///< rows below the supernodes, increasing
  std::vector<std::uint32_t> in_parent; ///< index of each of these rows in the rows of the parent
  std::vector<std::size_t> first_value; ///< of each panel, and the end
  /// An entry of the lower triangle of the matrix, without the diagonal.
  struct Entry
  {
    std::uint32_t place; ///< in its panel with all `w + m` rows of each column
    std::uint32_t index; ///< among all entries of the matrix
  };
  std::vector<Entry> matrix_entry;             ///< by supernode
  std::vector<std::size_t> first_matrix_entry; ///< of each supernode, and the end
  std::size_t stack_size = 0; ///< maximum number of values stored for a later parent
  std::size_t largest_number_of_rows_below = 0;
  std::size_t largest_panel = 0; ///< with all rows [count of values]
  Elimination_subtrees subtrees;

  Cholesky_pattern() = default;

  /// \param a square and compressed; entries above the diagonal are ignored
  /// \param rank distinct numbers, one per row: rows are eliminated by increasing rank as far as
  ///        the entries permit. Empty: minimum degree order.
  /// \param go_on called after each step; if it returns `false`, the pattern remains incomplete
  explicit Cholesky_pattern(const Matrix& a,
                            const std::vector<std::uint32_t>& rank = {},
                            const pcs::internal::Go_on& go_on = {})
  {
    using pcs::internal::goes_on;
    if (!goes_on(go_on, 0))
      return;
    new_of_old = rank.empty() ? minimum_degree_order(a) : order_by_rank(rank);
    if (!goes_on(go_on, 0.6))
      return;
    std::vector<std::uint32_t> tree = elimination_tree(adjacency(a)), count;
    renumber(postorder(tree, {}), tree, count); // required by the counts
    if (!goes_on(go_on, 0.7))
      return;
    count = column_counts(adjacency(a), tree);
    renumber(postorder(tree, count), tree, count);
    if (!goes_on(go_on, 0.8))
      return;
    find_supernodes(tree, count);
    const Adjacency graph = adjacency(a);
    find_rows(graph);
    if (!goes_on(go_on, 0.9))
      return;
    find_places(a);
    subtrees.find(*this);
    m_is_complete = true;
  }

  /// Whether it was not stopped. An incomplete pattern permits only destruction and assignment.
  bool is_complete() const { return m_is_complete; }

  /// Returns the index of each row in the order of elimination. The factor of any subset of the
  /// rows in that order has no entries that the complete factor lacks.
  static std::vector<std::uint32_t> minimum_degree_order(const Matrix& a)
  {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> old_of_new;
    Eigen::AMDOrdering<int>()(a.selfadjointView<Eigen::Lower>(), old_of_new);
    std::vector<std::uint32_t> result(static_cast<std::size_t>(a.rows()));
    for (std::size_t i = 0; i < result.size(); ++i)
      result[static_cast<std::size_t>(old_of_new.indices()[static_cast<Eigen::Index>(i)])] =
          static_cast<std::uint32_t>(i);
    return result;
  }

  /// Frees the memory that only factorisations need. Solutions remain possible.
  void forget_places()
  {
    if (!subtrees.row.empty())
      row = std::vector<std::uint32_t>();
    matrix_entry = std::vector<Entry>();
    first_matrix_entry = std::vector<std::size_t>();
    in_parent = std::vector<std::uint32_t>();
  }

  /// Rows below the supernodes, for solutions.
  const std::vector<std::uint32_t>& rows_of_solutions() const
  {
    return subtrees.row.empty() ? row : subtrees.row;
  }

  std::size_t size() const { return new_of_old.size(); }
  std::size_t number_of_supernodes() const { return parent.size(); }
  std::size_t width(std::size_t s) const { return first[s + 1] - first[s]; }
  std::size_t number_of_rows_below(std::size_t s) const { return first_row[s + 1] - first_row[s]; }
  /// Returns the index of the first value of a column of a panel, relative to that of the panel.
  /// The column has the values of the rows after its own.
  std::size_t first_of_column(std::size_t s, std::size_t column) const
  {
    const std::size_t height = width(s) + number_of_rows_below(s);
    return column * (height - 1) - (column > 0 ? column * (column - 1) / 2 : 0);
  }
  std::size_t number_of_values() const { return first_value.empty() ? 0 : first_value.back(); }

private:
  bool m_is_complete = false;

  /// Both triangles without the diagonal, in the current order.
  struct Adjacency
  {
    std::vector<std::size_t> first;
    std::vector<std::uint32_t> neighbor;
  };

  static std::vector<std::uint32_t> order_by_rank(const std::vector<std::uint32_t>& rank)
  {
    std::vector<std::uint32_t> row(*std::max_element(rank.begin(), rank.end()) + 1, none);
    for (std::size_t i = 0; i < rank.size(); ++i)
      row[rank[i]] = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> result(rank.size());
    std::uint32_t place = 0;
    for (const std::uint32_t i : row)
      if (i != none)
        result[i] = place++;
    return result;
  }

  template <class F>
  void for_each_entry_below_diagonal(const Matrix& a, const F& f) const
  {
    for (Eigen::Index column = 0; column < a.outerSize(); ++column)
      for (Matrix::InnerIterator entry(a, column); entry; ++entry)
        if (entry.row() > column)
          f(new_of_old[static_cast<std::size_t>(entry.row())],
            new_of_old[static_cast<std::size_t>(column)]);
  }

  Adjacency adjacency(const Matrix& a) const
  {
    Adjacency g;
    g.first.assign(size() + 1, 0);
    for_each_entry_below_diagonal(a, [&](std::uint32_t i, std::uint32_t j) {
      ++g.first[i + 1];
      ++g.first[j + 1];
    });
    std::partial_sum(g.first.begin(), g.first.end(), g.first.begin());
    g.neighbor.resize(g.first.back());
    std::vector<std::size_t> at(g.first.begin(), g.first.end() - 1);
    for_each_entry_below_diagonal(a, [&](std::uint32_t i, std::uint32_t j) {
      g.neighbor[at[i]++] = j;
      g.neighbor[at[j]++] = i;
    });
    return g;
  }

  /// Applies an order to the elimination tree and, unless they are empty, to the column counts.
  void renumber(const std::vector<std::uint32_t>& order,
                std::vector<std::uint32_t>& tree,
                std::vector<std::uint32_t>& count)
  {
    for (auto& i : new_of_old)
      i = order[i];
    std::vector<std::uint32_t> new_tree(tree.size(), none), new_count(count.size());
    for (std::size_t i = 0; i < tree.size(); ++i) {
      if (tree[i] != none)
        new_tree[order[i]] = order[tree[i]];
      if (!count.empty())
        new_count[order[i]] = count[i];
    }
    tree.swap(new_tree);
    count.swap(new_count);
  }

  /// Returns the parent of each column: the first row below its diagonal in the factor.
  static std::vector<std::uint32_t> elimination_tree(const Adjacency& g)
  {
    const std::size_t n = g.first.size() - 1;
    std::vector<std::uint32_t> tree(n, none), ancestor(n, none);
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::size_t e = g.first[i]; e < g.first[i + 1]; ++e)
        for (std::uint32_t k = g.neighbor[e]; k < i;) {
          const std::uint32_t next = ancestor[k];
          ancestor[k] = i;
          if (next == none) {
            tree[k] = i;
            break;
          }
          k = next;
        }
    return tree;
  }

  /// Returns the new number of each column: children before parents, subtrees contiguous, the child
  /// with the largest `count` last.
  static std::vector<std::uint32_t> postorder(const std::vector<std::uint32_t>& tree,
                                              const std::vector<std::uint32_t>& count)
  {
    const std::size_t n = tree.size();
    std::vector<std::uint32_t> child(n, none), sibling(n, none), order(n);
    const auto put_first = [&](std::size_t j) {
      if (tree[j] != none) {
        sibling[j] = child[tree[j]];
        child[tree[j]] = static_cast<std::uint32_t>(j);
      }
    };
    for (std::size_t j = n; j-- > 0;)
      put_first(j);
    if (!count.empty())
      for (std::size_t p = 0; p < n; ++p) { // move the largest child to the end
        std::uint32_t largest = none, before_largest = none, last = none;
        for (std::uint32_t c = child[p], before = none; c != none; before = c, c = sibling[c]) {
          if (largest == none || count[c] >= count[largest]) {
            largest = c;
            before_largest = before;
          }
          last = c;
        }
        if (largest == last)
          continue;
        (before_largest == none ? child[p] : sibling[before_largest]) = sibling[largest];
        sibling[last] = largest;
        sibling[largest] = none;
      }
    std::uint32_t next = 0;
    std::vector<std::uint32_t> stack;
    for (std::uint32_t root = 0; root < n; ++root) {
      if (tree[root] != none)
        continue;
      stack.push_back(root);
      while (!stack.empty()) {
        const std::uint32_t j = stack.back();
        if (child[j] == none) {
          order[j] = next++;
          stack.pop_back();
        } else {
          const std::uint32_t c = child[j];
          child[j] = sibling[c];
          stack.push_back(c);
        }
      }
    }
    return order;
  }

  /// Counts the entries of each column of the factor, with the diagonal. Columns are in postorder.
  static std::vector<std::uint32_t> column_counts(const Adjacency& g,
                                                  const std::vector<std::uint32_t>& tree)
  {
    const std::size_t n = tree.size();
    std::vector<std::uint32_t> descendant(n), ancestor(n), largest_first(n, none),
        previous_leaf(n, none);
    std::vector<std::int64_t> count(n, 1);
    std::iota(descendant.begin(), descendant.end(), 0u); // the first descendant
    std::iota(ancestor.begin(), ancestor.end(), 0u);
    for (std::size_t j = 0; j < n; ++j)
      if (tree[j] != none) {
        descendant[tree[j]] = std::min(descendant[tree[j]], descendant[j]);
        count[tree[j]] = 0;
      }
    for (std::uint32_t j = 0; j < n; ++j) {
      if (tree[j] != none)
        --count[tree[j]];
      for (std::size_t e = g.first[j]; e < g.first[j + 1]; ++e) {
        const std::uint32_t i = g.neighbor[e];
        if (i < j || (largest_first[i] != none && descendant[j] <= largest_first[i]))
          continue; // not a leaf of the subtree of row i
        largest_first[i] = descendant[j];
        ++count[j];
        const std::uint32_t previous = previous_leaf[i];
        previous_leaf[i] = j;
        if (previous == none)
          continue;
        std::uint32_t root = previous; // the common ancestor of both leaves
        while (ancestor[root] != root)
          root = ancestor[root];
        for (std::uint32_t k = previous; k != root;)
          k = std::exchange(ancestor[k], root);
        --count[root];
      }
      if (tree[j] != none)
        ancestor[j] = tree[j];
    }
    std::vector<std::uint32_t> result(n);
    for (std::size_t j = 0; j < n; ++j) {
      result[j] = static_cast<std::uint32_t>(count[j]);
      if (tree[j] != none)
        count[tree[j]] += count[j];
    }
    return result;
  }

  /// Returns whether a supernode of `width` columns may contain `zeros` zeros among its `values`
  /// values: at most a fraction, which is smaller for wider supernodes.
  static bool is_worth(std::size_t width, std::size_t zeros, std::size_t values)
  {
    const double share = static_cast<double>(zeros) / static_cast<double>(values);
    return share < (width <= 8 ? 0.25 : width <= 32 ? 0.12 : 0.05);
  }

  void find_supernodes(const std::vector<std::uint32_t>& tree,
                       const std::vector<std::uint32_t>& count)
  {
    const std::size_t n = tree.size();
    struct Group
    {
      std::uint32_t first;
      std::size_t zeros;
    };
    std::vector<Group> groups; // a stack: the last groups end at the current column
    const auto height = [&](const Group& g, std::size_t last) {
      return last - g.first + count[last]; // number of rows of the panel
    };
    for (std::uint32_t j = 0; j < n; ++j) {
      groups.push_back({j, 0});
      // The previous group ends with column j - 1. It may be merged into this one if j is the
      // parent of column j - 1.
      while (groups.size() > 1) {
        const Group own = groups.back(), before = groups[groups.size() - 2];
        if (own.first == 0 || tree[own.first - 1] == none || tree[own.first - 1] > j)
          break;
        const std::size_t last = own.first - 1, width = j + 1 - before.first;
        const std::size_t added =
            (own.first - before.first) * (height({before.first, 0}, j) - height(before, last));
        const std::size_t zeros = own.zeros + before.zeros + added;
        const bool is_same = added == 0 && own.first == j;
        const std::size_t values = height({before.first, 0}, j) * width;
        if (!is_same && !is_worth(width, zeros, values))
          break;
        groups.pop_back();
        groups.back().zeros = zeros;
      }
    }
    std::vector<std::uint32_t> of_column(n);
    for (const Group& g : groups)
      first.push_back(g.first);
    const std::size_t m = first.size();
    first.push_back(static_cast<std::uint32_t>(n));
    for (std::uint32_t s = 0; s < m; ++s)
      std::fill(of_column.begin() + first[s], of_column.begin() + first[s + 1], s);
    parent.assign(m, none);
    for (std::size_t s = 0; s < m; ++s)
      if (tree[first[s + 1] - 1] != none)
        parent[s] = of_column[tree[first[s + 1] - 1]];
  }

  void find_rows(const Adjacency& g)
  {
    const std::size_t m = number_of_supernodes();
    std::vector<std::uint32_t> mark(size(), none), child(m, none), sibling(m, none);
    first_row.assign(1, 0);
    for (std::uint32_t s = 0; s < m; ++s) {
      const std::uint32_t end = first[s + 1];
      const auto add = [&](std::uint32_t i) {
        if (i >= end && mark[i] != s) {
          mark[i] = s;
          row.push_back(i);
        }
      };
      for (std::uint32_t j = first[s]; j < end; ++j)
        for (std::size_t e = g.first[j]; e < g.first[j + 1]; ++e)
          add(g.neighbor[e]);
      for (std::uint32_t c = child[s]; c != none; c = sibling[c])
        for (std::size_t r = first_row[c]; r < first_row[c + 1]; ++r)
          add(row[r]);
      std::sort(row.begin() + static_cast<std::ptrdiff_t>(first_row[s]), row.end());
      first_row.push_back(row.size());
      if (parent[s] != none)
        sibling[s] = std::exchange(child[parent[s]], s);
    }
    row.shrink_to_fit();
    first_value.assign(1, 0);
    for (std::size_t s = 0; s < m; ++s) {
      largest_panel = std::max(largest_panel, (width(s) + number_of_rows_below(s)) * width(s));
      first_value.push_back(first_value.back() + first_of_column(s, width(s)));
    }
    in_parent.resize(row.size());
    for (std::size_t s = 0; s < m; ++s) {
      const std::uint32_t p = parent[s];
      if (p == none)
        continue;
      std::size_t at = first_row[p];
      for (std::size_t r = first_row[s]; r < first_row[s + 1]; ++r)
        if (row[r] < first[p + 1])
          in_parent[r] = row[r] - first[p];
        else {
          while (row[at] != row[r])
            ++at;
          in_parent[r] = static_cast<std::uint32_t>(width(p) + at - first_row[p]);
        }
    }
    // In postorder, the pending updates form a stack, with the updates of the children of the
    // current supernode on top.
    std::size_t waiting = 0;
    std::vector<std::size_t> of_children(m, 0);
    for (std::size_t s = 0; s < m; ++s) {
      const std::size_t below = number_of_rows_below(s), own = below * below;
      largest_number_of_rows_below = std::max(largest_number_of_rows_below, below);
      stack_size = std::max(stack_size, waiting + own);
      waiting += own;
      waiting -= of_children[s];
      if (parent[s] != none)
        of_children[parent[s]] += own;
    }
  }

  void find_places(const Matrix& a)
  {
    std::vector<std::uint32_t> of_column(size());
    for (std::uint32_t s = 0; s < number_of_supernodes(); ++s)
      std::fill(of_column.begin() + first[s], of_column.begin() + first[s + 1], s);
    // Calls `use(supernode, row, column, index)`, with row and column in the order of elimination.
    const auto for_each_entry = [&](const auto& use) {
      std::uint32_t index = 0;
      for (Eigen::Index column = 0; column < a.outerSize(); ++column)
        for (Matrix::InnerIterator entry(a, column); entry; ++entry, ++index) {
          if (entry.row() <= column)
            continue;
          const std::uint32_t i = new_of_old[static_cast<std::size_t>(entry.row())];
          const std::uint32_t j = new_of_old[static_cast<std::size_t>(column)];
          use(of_column[std::min(i, j)], std::max(i, j), std::min(i, j), index);
        }
    };
    first_matrix_entry.assign(number_of_supernodes() + 1, 0);
    for_each_entry([&](std::uint32_t s, std::uint32_t, std::uint32_t, std::uint32_t) {
      ++first_matrix_entry[s + 1];
    });
    std::partial_sum(first_matrix_entry.begin(),
                     first_matrix_entry.end(),
                     first_matrix_entry.begin());
    matrix_entry.resize(first_matrix_entry.back());
    std::vector<std::size_t> at(first_matrix_entry.begin(), first_matrix_entry.end() - 1);
    for_each_entry([&](std::uint32_t s, std::uint32_t i, std::uint32_t j, std::uint32_t index) {
      std::size_t r = i - first[s];
      if (i >= first[s + 1]) {
        const auto begin = row.begin() + static_cast<std::ptrdiff_t>(first_row[s]);
        const auto end = row.begin() + static_cast<std::ptrdiff_t>(first_row[s + 1]);
        r = width(s) + static_cast<std::size_t>(std::lower_bound(begin, end, i) - begin);
      }
      const std::size_t place = (j - first[s]) * (width(s) + number_of_rows_below(s)) + r;
      matrix_entry[at[s]++] = {static_cast<std::uint32_t>(place), index};
    });
  }
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_CHOLESKY_PATTERN_H
