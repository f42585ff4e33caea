// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sparse Cholesky factor L D L^T by supernodes, with triangular solves for several right-hand sides
// at once.

#ifndef PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H
#define PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H

#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/linear_algebra/Cholesky_pattern.h>
#include <pcs/linear_algebra/Factor_values.h>
#include <pcs/linear_algebra/dense_front.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace pcs {
namespace linear_algebra {

/*!
  Factor of a symmetric positive definite sparse matrix, by the multifrontal method (Duff and Reid
  1983) on the panels of a `Cholesky_pattern`. Factors of matrices with the same sparsity pattern
  may use the same `Cholesky_pattern`, whose computation takes half of the time for small matrices.
  `solve()` is const, allocates nothing if the work vector of the caller is large enough, and may
  run concurrently with other solves.
*/
class Sparse_cholesky
{
public:
  using Matrix = Cholesky_pattern::Matrix;

  /*!
    Factorises `a`, which is compressed, and of which only the lower triangle is read. Rows are
    eliminated in the order of `rank` unless it is empty. Returns `false` if `a` is not positive
    definite.

    \param row_sums the sum of each row of a Laplacian with added diagonal, at least 0. If given, no
        entry off the diagonal may be positive, and the diagonal is not read. The elimination then
        adds numbers of equal signs only (Grassmann, Taksar, Heyman 1985; Alfa, Xue, Ye 2002), so
        that every entry of the factor is accurate, whatever the ratio of the weights. Sums of
        entries of `a` would lose the small ones.
  */
  bool factorize(const Matrix& a,
                 const std::vector<std::uint32_t>& rank = {},
                 const std::vector<double>& row_sums = {})
  {
    return factorize(a, std::make_shared<const Cholesky_pattern>(a, rank), row_sums);
  }

  /// Factorises a matrix with the sparsity pattern of `pattern`.
  /// \param go_on called about every `products_between_calls`; if it returns `false`, this
  ///        function does so, too, and the factor must not be used
  /// \param value_size of the result; the factorisation itself has double precision. Fewer than
  ///        eight bytes require row sums. Errors of solutions are then those of the values, times
  ///        the condition number at most
  bool factorize(const Matrix& a,
                 std::shared_ptr<const Cholesky_pattern> pattern,
                 const std::vector<double>& row_sums = {},
                 const pcs::internal::Go_on& go_on = {},
                 Value_size value_size = Value_size::eight)
  {
    m_pattern = std::move(pattern);
    const Cholesky_pattern& p = *m_pattern;
    if (!m_value.resize(p.number_of_values(), value_size, go_on))
      return false;
    m_inverse_diagonal.resize(size());
    std::vector<double> diagonal(size(), 0);
    for (Eigen::Index column = 0; row_sums.empty() && column < a.outerSize(); ++column)
      for (Matrix::InnerIterator i(a, column); i; ++i)
        if (i.row() == column)
          diagonal[p.new_of_old[static_cast<std::size_t>(column)]] = i.value();
    for (std::size_t i = 0; i < row_sums.size(); ++i)
      diagonal[p.new_of_old[i]] = row_sums[i];
    return factorize_panels(a.valuePtr(), diagonal, !row_sums.empty(), go_on);
  }

  /// The pattern of the last matrix; null before the first factorisation.
  const std::shared_ptr<const Cholesky_pattern>& pattern() const { return m_pattern; }

  std::size_t size() const { return m_pattern ? m_pattern->size() : 0; }

  /// Number of entries of the factor below the diagonal, with the zeros in the panels.
  std::size_t number_of_nonzeros() const
  {
    std::size_t sum = 0;
    for (std::size_t s = 0; size() > 0 && s < m_pattern->number_of_supernodes(); ++s) {
      const std::size_t w = m_pattern->width(s);
      sum += w * (w - 1) / 2 + w * m_pattern->number_of_rows_below(s);
    }
    return sum;
  }

  /// Solves `A x = b` for right-hand sides stored row by row: `Row` is a fixed-size Eigen vector.
  /// The subtrees of a large factor are processed in parallel if the tag allows it, with the same
  /// result for every number of threads.
  template <class ConcurrencyTag = CGAL::Sequential_tag, class Row>
  void solve(std::vector<Row>& b, std::vector<Row>& work) const
  {
    solve_each<ConcurrencyTag>([&](std::size_t row) -> const Row& { return b[row]; },
                               [&](std::size_t row, const Row& x) { b[row] = x; },
                               work);
  }

  /// The same for the right-hand side `load(row)`. The solution is passed to `store(row, x)` after
  /// all calls of `load`. Both are called concurrently if the tag allows it.
  template <class ConcurrencyTag, class Row, class Load, class Store>
  void solve_each(const Load& load, const Store& store, std::vector<Row>& work) const
  {
    work.resize(size_of_work());
    pcs::internal::for_each_index<ConcurrencyTag>(
        size(),
        [&](std::size_t i) { work[place_of_row(i)] = load(i); },
        512);
    solve_placed<ConcurrencyTag>(work);
    pcs::internal::for_each_index<ConcurrencyTag>(size(), [&](std::size_t i) {
      store(i, work[place_of_row(i)]);
    });
  }

  /// The same for a right-hand side that is already in `work`, which has `size_of_work()` entries,
  /// and where the solution replaces it. The entry of a row is `place_of_row(row)`.
  template <class ConcurrencyTag, class Row>
  void solve_placed(std::vector<Row>& work) const
  {
    m_value.visit([&](const auto& value) { solve_with<ConcurrencyTag>(value, work); });
  }

  std::size_t place_of_row(std::size_t row) const { return m_pattern->new_of_old[row]; }
  std::size_t size_of_work() const { return m_pattern ? m_pattern->subtrees.number_of_places : 0; }

private:
  /// \param value see `Factor_values::visit()`
  template <class ConcurrencyTag, class Values, class Row>
  void solve_with(const Values& value, std::vector<Row>& work) const
  {
    if (size() == 0)
      return;
    const Cholesky_pattern& p = *m_pattern;
    const Elimination_subtrees& trees = p.subtrees;
    const std::uint32_t* rows = p.rows_of_solutions().data();
    const auto number_above = [&](const Elimination_subtrees::Subtree& t) {
      return p.number_of_rows_below(t.end - 1);
    };
    const auto for_each_subtree = [&](const auto& f) {
      pcs::internal::for_each_block<ConcurrencyTag>(
          trees.subtree.size(),
          1,
          [&](std::size_t t, std::size_t) { f(trees.subtree[t]); });
    };
    for_each_subtree([&](const Elimination_subtrees::Subtree& t) {
      std::fill_n(work.begin() + static_cast<std::ptrdiff_t>(t.first_place),
                  number_above(t),
                  Row(Row::Zero()));
      for (std::size_t s = t.begin; s < t.end; ++s)
        solve_forward(value, s, rows, work);
    });
    for (const auto& t : trees.subtree)
      for (std::size_t k = 0; k < number_above(t); ++k)
        work[trees.above[t.first_above + k]] += work[t.first_place + k];
    for (const auto s : trees.top)
      solve_forward(value, s, rows, work);
    for (auto s = trees.top.rbegin(); s != trees.top.rend(); ++s)
      solve_backward(value, *s, rows, size(), work);
    for_each_subtree([&](const Elimination_subtrees::Subtree& t) {
      for (std::size_t k = 0; k < number_above(t); ++k)
        work[t.first_place + k] = work[trees.above[t.first_above + k]];
      for (std::size_t s = t.end; s-- > t.begin;)
        solve_backward(value, s, rows, t.scratch, work);
    });
  }

  struct Waiting
  {
    std::size_t supernode, offset;
  };

  /// Upper bound of the number of products for a supernode. [count]
  double products_of(std::size_t s) const
  {
    const auto width = static_cast<double>(m_pattern->width(s));
    const double height = width + static_cast<double>(m_pattern->number_of_rows_below(s));
    return width * height * height;
  }

  /// Counts the products of a factorisation for `go_on`.
  class Work_counter
  {
  public:
    Work_counter(const Sparse_cholesky& factor, const pcs::internal::Go_on& go_on)
      : m_factor(factor), m_go_on(go_on)
    {
      for (std::size_t s = 0; m_go_on && s < factor.m_pattern->number_of_supernodes(); ++s)
        m_all += factor.products_of(s);
    }

    /// Asks, without further work. Inside a large supernode, its work does not count yet.
    bool operator()() { return !m_go_on || m_go_on(m_all > 0 ? m_done / m_all : 1); }

    /// Adds the work of a supernode, and asks if this has not been done for some time.
    bool finish(std::size_t s)
    {
      if (!m_go_on)
        return true;
      const double products = m_factor.products_of(s);
      m_done += products;
      m_since += products;
      if (m_since < products_between_calls)
        return true;
      m_since = 0;
      return (*this)();
    }

  private:
    const Sparse_cholesky& m_factor;
    const pcs::internal::Go_on& m_go_on;
    double m_all = 0, m_done = 0, m_since = 0;
  };

  /// Factorises panel by panel. A stack stores the updates of a panel until its parent is reached.
  /// \param entries values of the matrix
  /// \param has_row_sums whether `diagonal` has the sums of the rows
  bool factorize_panels(const double* entries,
                        std::vector<double>& diagonal,
                        bool has_row_sums,
                        const pcs::internal::Go_on& go_on)
  {
    Work_counter work(*this, go_on);
    const std::function<bool()> ask = [&] { return work(); };
    const Cholesky_pattern& p = *m_pattern;
    const Factorize_front factorize_front = choose_factorize_front();
    std::vector<double> stack(p.stack_size), dense(p.largest_panel), scaled(p.largest_panel);
    std::vector<double> diagonal_below(p.largest_number_of_rows_below);
    std::vector<Waiting> waiting;
    std::size_t top = 0;
    for (std::size_t s = 0; s < p.number_of_supernodes(); ++s) {
      const std::size_t width = p.width(s), below = p.number_of_rows_below(s);
      const Dense_columns panel{dense.data(), width + below};
      std::fill_n(panel.value, (width + below) * width, 0.0);
      for (std::size_t e = p.first_matrix_entry[s]; e < p.first_matrix_entry[s + 1]; ++e)
        panel.value[p.matrix_entry[e].place] = entries[p.matrix_entry[e].index];
      const Dense_columns rest{stack.data() + top, below};
      std::fill_n(rest.value, below * below, 0.0);
      auto first_child = waiting.end();
      while (first_child != waiting.begin() && p.parent[(first_child - 1)->supernode] == s)
        --first_child;
      for (auto child = first_child; child != waiting.end(); ++child)
        add_child(child->supernode, stack.data() + child->offset, panel, width, rest);
      const std::uint32_t* row = p.row.data() + p.first_row[s];
      for (std::size_t r = 0; r < below; ++r)
        diagonal_below[r] = diagonal[row[r]];
      if (!factorize_front({panel,
                            {scaled.data(), width + below},
                            width + below,
                            width,
                            rest,
                            diagonal.data() + p.first[s],
                            diagonal_below.data(),
                            has_row_sums,
                            &ask}) ||
          !work.finish(s))
        return false;
      for (std::size_t r = 0; r < below; ++r)
        diagonal[row[r]] = diagonal_below[r];
      for (std::size_t c = 0; c < width; ++c) {
        const double inverse = 1 / *panel.at(c, c);
        if (!std::isfinite(inverse))
          return false;
        m_inverse_diagonal[p.first[s] + c] = inverse;
        m_value.set(p.first_value[s] + p.first_of_column(s, c),
                    panel.at(c + 1, c),
                    width + below - c - 1);
      }
      if (first_child != waiting.end()) {
        std::copy_n(rest.value, below * below, stack.data() + first_child->offset);
        top = first_child->offset;
        waiting.erase(first_child, waiting.end());
      }
      if (below > 0)
        waiting.push_back({s, top});
      top += below * below;
    }
    return true;
  }

  void add_child(std::size_t child,
                 const double* from,
                 const Dense_columns& panel,
                 std::size_t width,
                 const Dense_columns& rest) const
  {
    const std::size_t n = m_pattern->number_of_rows_below(child);
    const std::uint32_t* place = m_pattern->in_parent.data() + m_pattern->first_row[child];
    for (std::size_t j = 0; j < n; ++j, from += n) {
      const std::size_t column = place[j];
      double* to = column < width
                       ? panel.at(0, column)
                       : rest.at(0, column - width) - width; // rows count from the panel's first
      for (std::size_t i = j; i < n; ++i)
        to[place[i]] += from[i];
    }
  }

  /// \param rows indices in `work` of the rows below
  template <class Row, class Values>
  void solve_forward(const Values& value,
                     std::size_t s,
                     const std::uint32_t* rows,
                     std::vector<Row>& work) const
  {
    const Cholesky_pattern& p = *m_pattern;
    const std::size_t width = p.width(s), below = p.number_of_rows_below(s);
    Row* own = work.data() + p.first[s];
    std::size_t first = p.first_value[s]; // of the column; the next one begins after its rows
    for (std::size_t c = 0; c < width; first += width + below - ++c) {
      const Row x = own[c];
      const auto column = value.column(first);
      for (std::size_t r = c + 1; r < width; ++r)
        own[r] -= column[r - c - 1] * x;
    }
    const std::uint32_t* row = rows + p.first_row[s];
    // the values of the rows below: their distance from column to column decreases
    const auto below_of = [&](std::size_t c) {
      return value.column(p.first_value[s] + p.first_of_column(s, c) + width - c - 1);
    };
    std::size_t c = 0;
    for (; c + 3 <= width; c += 3) {
      const Row x = own[c], y = own[c + 1], z = own[c + 2];
      const auto of_x = below_of(c), of_y = below_of(c + 1), of_z = below_of(c + 2);
      for (std::size_t r = 0; r < below; ++r)
        work[row[r]] -= of_x[r] * x + of_y[r] * y + of_z[r] * z;
    }
    for (; c < width; ++c) {
      const Row x = own[c];
      const auto of_x = below_of(c);
      for (std::size_t r = 0; r < below; ++r)
        work[row[r]] -= of_x[r] * x;
    }
    for (c = 0; c < width; ++c)
      own[c] *= m_inverse_diagonal[p.first[s] + c];
  }

  /// \param rows indices in `work` of the rows below
  /// \param scratch index in `work` of temporary entries for them
  template <class Row, class Values>
  void solve_backward(const Values& value,
                      std::size_t s,
                      const std::uint32_t* rows,
                      std::size_t scratch,
                      std::vector<Row>& work) const
  {
    const Cholesky_pattern& p = *m_pattern;
    const std::size_t width = p.width(s), below = p.number_of_rows_below(s);
    const std::uint32_t* row = rows + p.first_row[s];
    Row *own = work.data() + p.first[s], *gathered = work.data() + scratch;
    for (std::size_t r = 0; r < below; ++r)
      gathered[r] = work[row[r]];
    const auto below_of = [&](std::size_t c) {
      return value.column(p.first_value[s] + p.first_of_column(s, c) + width - c - 1);
    };
    std::size_t c = 0;
    for (; c + 2 <= width; c += 2) {
      Row sum = own[c], next = own[c + 1];
      const auto of_sum = below_of(c), of_next = below_of(c + 1);
      for (std::size_t r = 0; r < below; ++r) {
        sum -= of_sum[r] * gathered[r];
        next -= of_next[r] * gathered[r];
      }
      own[c] = sum;
      own[c + 1] = next;
    }
    if (c < width) {
      Row sum = own[c];
      const auto of_sum = below_of(c);
      for (std::size_t r = 0; r < below; ++r)
        sum -= of_sum[r] * gathered[r];
      own[c] = sum;
    }
    for (c = width; c-- > 0;) {
      Row sum = own[c];
      const auto column = value.column(p.first_value[s] + p.first_of_column(s, c));
      for (std::size_t r = c + 1; r < width; ++r)
        sum -= column[r - c - 1] * own[r];
      own[c] = sum;
    }
  }

  std::shared_ptr<const Cholesky_pattern> m_pattern;
  Factor_values m_value;
  std::vector<double> m_inverse_diagonal;
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H
