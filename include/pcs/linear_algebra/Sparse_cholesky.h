// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sparse Cholesky factor L D L^T by supernodes, with triangular solves for several right-hand sides
// at once.

#ifndef PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H
#define PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H

#include <pcs/internal/parallel.h>
#include <pcs/internal/progress.h>
#include <pcs/linear_algebra/Cholesky_pattern.h>
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
    Factorises `a`, of which only the lower triangle is read. Rows are eliminated in the order of
    `rank` unless it is empty. Returns `false` if `a` is not positive definite.

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
  bool factorize(const Matrix& a,
                 std::shared_ptr<const Cholesky_pattern> pattern,
                 const std::vector<double>& row_sums = {},
                 const pcs::internal::Go_on& go_on = {})
  {
    m_pattern = std::move(pattern);
    const Cholesky_pattern& p = *m_pattern;
    m_single = std::vector<float>();
    m_value.clear();
    m_value.reserve(p.number_of_values());
    while (m_value.size() < p.number_of_values()) { // in parts, since new memory takes time
      m_value.resize(std::min(p.number_of_values(), m_value.size() + values_between_calls), 0);
      if (!pcs::internal::goes_on(go_on, 0))
        return false;
    }
    m_inverse_diagonal.resize(size());
    std::vector<double> diagonal(size(), 0);
    std::size_t entry = 0;
    for (Eigen::Index column = 0; column < a.outerSize(); ++column)
      for (Matrix::InnerIterator i(a, column); i; ++i)
        if (i.row() >= column) {
          m_value[p.place[entry++]] = i.value();
          if (i.row() == column)
            diagonal[p.new_of_old[static_cast<std::size_t>(column)]] = i.value();
        }
    for (std::size_t i = 0; i < row_sums.size(); ++i)
      diagonal[p.new_of_old[i]] = row_sums[i];
    return factorize_panels(diagonal, !row_sums.empty(), go_on);
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
    if (m_single.empty())
      solve_with<ConcurrencyTag>(m_value.data(), b, work);
    else
      solve_with<ConcurrencyTag>(m_single.data(), b, work);
  }

  /// Rounds the factor below the diagonal to single precision, which halves its memory. Solutions
  /// are then accurate to about 1e-7 times the condition number. Ends with the next factorisation.
  void round_to_single()
  {
    m_single.assign(m_value.begin(), m_value.end());
    m_value = std::vector<double>();
  }

private:
  /// Number of values of the factor that are set to zero between two calls of `go_on`. [count]
  static constexpr std::size_t values_between_calls = 10000000;

  /// \param value of the panels
  template <class ConcurrencyTag, class Value, class Row>
  void solve_with(const Value* value, std::vector<Row>& b, std::vector<Row>& work) const
  {
    if (size() == 0)
      return;
    const Cholesky_pattern& p = *m_pattern;
    const Elimination_subtrees& trees = p.subtrees;
    const auto for_each_subtree = [&](const auto& f) {
      pcs::internal::for_each_block<ConcurrencyTag>(
          trees.subtree.size(),
          1,
          [&](std::size_t t, std::size_t) { f(trees.subtree[t]); });
    };
    work.resize(trees.number_of_places);
    pcs::internal::for_each_index<ConcurrencyTag>(size(), [&](std::size_t i) {
      work[p.new_of_old[i]] = b[i];
    });
    for_each_subtree([&](const Elimination_subtrees::Subtree& t) {
      std::fill_n(work.begin() + static_cast<std::ptrdiff_t>(t.first_place),
                  p.number_of_rows_below(t.end - 1),
                  Row(Row::Zero()));
      for (std::size_t s = t.begin; s < t.end; ++s)
        solve_forward(value, s, trees.row.data(), work);
    });
    for (const auto& t : trees.subtree)
      for (std::size_t r = p.first_row[t.end - 1], at = t.first_place; r < p.first_row[t.end]; ++r)
        work[p.row[r]] += work[at++];
    for (const auto s : trees.top)
      solve_forward(value, s, p.row.data(), work);
    for (auto s = trees.top.rbegin(); s != trees.top.rend(); ++s)
      solve_backward(value, *s, size(), work);
    for_each_subtree([&](const Elimination_subtrees::Subtree& t) {
      for (std::size_t s = t.end; s-- > t.begin;)
        solve_backward(value, s, t.scratch, work);
    });
    pcs::internal::for_each_index<ConcurrencyTag>(size(), [&](std::size_t i) {
      b[i] = work[p.new_of_old[i]];
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
  /// \param has_row_sums whether `diagonal` has the sums of the rows
  bool factorize_panels(std::vector<double>& diagonal,
                        bool has_row_sums,
                        const pcs::internal::Go_on& go_on)
  {
    Work_counter work(*this, go_on);
    const std::function<bool()> ask = [&] { return work(); };
    const Cholesky_pattern& p = *m_pattern;
    const Factorize_front factorize_front = choose_factorize_front();
    std::vector<double> stack(p.stack_size), scaled(p.largest_panel);
    std::vector<double> diagonal_below(p.largest_number_of_rows_below);
    std::vector<Waiting> waiting;
    std::size_t top = 0;
    for (std::size_t s = 0; s < p.number_of_supernodes(); ++s) {
      const std::size_t width = p.width(s), below = p.number_of_rows_below(s);
      const Dense_columns panel{m_value.data() + p.first_value[s], width + below};
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
  template <class Row, class Value>
  void solve_forward(const Value* value,
                     std::size_t s,
                     const std::uint32_t* rows,
                     std::vector<Row>& work) const
  {
    const Cholesky_pattern& p = *m_pattern;
    const std::size_t width = p.width(s), below = p.number_of_rows_below(s), height = width + below;
    const Value* panel = value + p.first_value[s];
    const auto at = [](const Value& v) { return static_cast<double>(v); };
    Row* own = work.data() + p.first[s];
    for (std::size_t c = 0; c < width; ++c) {
      const Row x = own[c];
      for (std::size_t r = c + 1; r < width; ++r)
        own[r] -= at(panel[c * height + r]) * x;
    }
    const std::uint32_t* row = rows + p.first_row[s];
    panel += width;
    std::size_t c = 0;
    for (; c + 3 <= width; c += 3, panel += 3 * height) {
      const Row x = own[c], y = own[c + 1], z = own[c + 2];
      for (std::size_t r = 0; r < below; ++r)
        work[row[r]] -=
            at(panel[r]) * x + at(panel[height + r]) * y + at(panel[2 * height + r]) * z;
    }
    for (; c < width; ++c, panel += height) {
      const Row x = own[c];
      for (std::size_t r = 0; r < below; ++r)
        work[row[r]] -= at(panel[r]) * x;
    }
    for (c = 0; c < width; ++c)
      own[c] *= m_inverse_diagonal[p.first[s] + c];
  }

  /// \param scratch index in `work` of temporary entries for the rows below
  template <class Row, class Value>
  void solve_backward(const Value* value,
                      std::size_t s,
                      std::size_t scratch,
                      std::vector<Row>& work) const
  {
    const Cholesky_pattern& p = *m_pattern;
    const std::size_t width = p.width(s), below = p.number_of_rows_below(s), height = width + below;
    const Value* panel = value + p.first_value[s];
    const auto at = [](const Value& v) { return static_cast<double>(v); };
    const std::uint32_t* row = p.row.data() + p.first_row[s];
    Row *own = work.data() + p.first[s], *gathered = work.data() + scratch;
    for (std::size_t r = 0; r < below; ++r)
      gathered[r] = work[row[r]];
    const Value* column = panel + width;
    std::size_t c = 0;
    for (; c + 2 <= width; c += 2, column += 2 * height) {
      Row sum = own[c], next = own[c + 1];
      for (std::size_t r = 0; r < below; ++r) {
        sum -= at(column[r]) * gathered[r];
        next -= at(column[height + r]) * gathered[r];
      }
      own[c] = sum;
      own[c + 1] = next;
    }
    if (c < width) {
      Row sum = own[c];
      for (std::size_t r = 0; r < below; ++r)
        sum -= at(column[r]) * gathered[r];
      own[c] = sum;
    }
    for (c = width; c-- > 0;) {
      Row sum = own[c];
      for (std::size_t r = c + 1; r < width; ++r)
        sum -= at(panel[c * height + r]) * own[r];
      own[c] = sum;
    }
  }

  std::shared_ptr<const Cholesky_pattern> m_pattern;
  std::vector<double> m_value; ///< values of the panels
  std::vector<float> m_single; ///< the same after `round_to_single()`
  std::vector<double> m_inverse_diagonal;
};

} // namespace linear_algebra
} // namespace pcs

#endif // PCS_LINEAR_ALGEBRA_SPARSE_CHOLESKY_H
