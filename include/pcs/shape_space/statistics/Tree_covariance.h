// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Covariance of trees of which some lack branches, by expectation maximisation.
//
// The values of block b of n trees are the rows of a matrix X_b [L] with one column per tree. Each
// row is a draw from a Gaussian over the trees with covariance s_b S: the n x n matrix S [-] of
// trace n is common to all blocks, the factor s_b [L^2] is not. For trees that have all blocks,
// with the deviations Z_b [L] of the rows from their means, the M-estimator of D. E. Tyler (Annals
// of Statistics 15, 1987) is a minimum over the matrices S on the n - 1 dimensions perpendicular to
// the vector 1 of
//
//   sum_b ((n - 1) ln tr(Z_b S^-1 Z_b^T) + ln det S),
//
// in which all blocks have the same influence, whatever their variance. It is a fixed point, up to
// its trace, of
//
//   S <- sum_b w_b (Z_b^T Z_b + U_b),   w_b = (k_b / n) / tr(Z_b (S + 0.02 I)^-1 Z_b^T)   [1/L^2]
//
// with the number k_b of trees that have the block; 0.02 is the least fraction of variance that no
// block shares with others. Values that trees lack are replaced by their expectations (A. P.
// Dempster, N. M. Laird, D. B. Rubin, J. of the Royal Statistical Society B 39, 1977): with the
// trees K that have the block and the others, O,
//
//   Z_O = Z_K S_KK^-1 S_KO,   U_OO = c (S_OO - S_OK S_KK^-1 S_KO),                          [L^2]
//   c = tr(Z_K S_KK^-1 Z_K^T) / max(1, k_b - 1),   mean = X_K S_KK^-1 1 / (1^T S_KK^-1 1)
//
// where 1e-6 is added to the diagonal of S. U_b is zero elsewhere; the mean of a block that all
// trees have is the arithmetic mean.

#ifndef PCS_SHAPE_SPACE_STATISTICS_TREE_COVARIANCE_H
#define PCS_SHAPE_SPACE_STATISTICS_TREE_COVARIANCE_H

#include <pcs/internal/parallel.h>
#include <pcs/shape_space/statistics/Tree_features.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Inverts a symmetric positive definite matrix by Gauss-Jordan elimination; pivots need no search.
inline Eigen::MatrixXd inverse_of_symmetric(Eigen::MatrixXd a)
{
  const Eigen::Index n = a.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    const double pivot = 1 / a(k, k);
    a(k, k) = 1;
    a.row(k) *= pivot;
    for (Eigen::Index i = 0; i < n; ++i)
      if (i != k) {
        const double f = a(i, k);
        a(i, k) = 0;
        a.row(i) -= f * a.row(k);
      }
  }
  return a;
}

} // namespace internal

/*!
  Covariance between `n` trees, of which some lack blocks of numbers, as stated at the head of this
  file.

  Without a start, the first step has `Z_O` and `U_b` zero and the inverse in `w_b` is `I`. Blocks
  that do not vary are left out. At most 60 steps, each O(sum_b (k_b^3 + rows_b n^2)).
*/
class Tree_covariance
{
public:
  /// `values`: one column per tree. `start`, if not empty, is near the solution.
  template <class ConcurrencyTag>
  Tree_covariance(const Tree_features& features,
                  const Eigen::MatrixXd& values,
                  const std::vector<std::vector<char>>& has,
                  double least_deviation,
                  const Eigen::MatrixXd& start,
                  ConcurrencyTag)
    : m_features(features), m_values(values), m_has(has), m_covariance(start)
  {
    const std::size_t blocks = features.number_of_blocks();
    m_mean.setZero(features.dimension());
    m_weight.assign(blocks, 0);
    m_variance.assign(blocks, 0);
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::vector<std::size_t> known = trees_with(b);
      if (known.size() < 2)
        continue;
      Eigen::MatrixXd z = block(b, known);
      z.colwise() -= Eigen::VectorXd(z.rowwise().mean());
      const double variance = z.squaredNorm() / static_cast<double>(known.size() - 1);
      if (variance > least_deviation * least_deviation)
        m_variance[b] = variance;
    }
    for (int step = 0; step < number_of_steps; ++step) {
      const Eigen::MatrixXd old = m_covariance;
      iterate<ConcurrencyTag>();
      if (!(m_covariance.trace() > 0) ||
          (old.size() > 0 && (m_covariance - old).norm() <= tolerance * m_covariance.norm()))
        break;
    }
    find_deviations();
  }

  /// Returns the covariance of the trees, n x n; the trace is n, or 0 if no block varies.
  const Eigen::MatrixXd& covariance() const { return m_covariance; }
  /// Returns the mean of each block over the trees, estimated from the trees that have it. [L]
  const Eigen::VectorXd& mean() const { return m_mean; }
  /// Returns the sum of the variances of the numbers of a block; 0 if it does not vary, or if fewer
  /// than two trees have it. [L^2]
  double variance(std::size_t block) const { return m_variance[block]; }
  /// Returns the weight of squared deviations of a block. [1/L^2]
  double weight(std::size_t block) const { return m_weight[block]; }

  /// Returns the deviations from the mean, one column per tree; unknown ones are their
  /// expectations. [L]
  const Eigen::MatrixXd& deviations() const { return m_deviations; }

private:
  static constexpr int number_of_steps = 60;
  static constexpr double tolerance = 1e-4, rounding = 1e-6;
  /// Least fraction of variance that no block shares with others. Without it, a block that equals a
  /// combination of others up to rounding would get all the weight. [-]
  static constexpr double own_fraction = 0.02;

  struct Completed_block
  {
    Eigen::MatrixXd deviations;
    Eigen::VectorXd mean;
    Eigen::MatrixXd uncertainty; ///< n x n, of the products of deviations
  };

  std::vector<std::size_t> trees_with(std::size_t b, bool is_there = true) const
  {
    std::vector<std::size_t> result;
    for (std::size_t t = 0; t < m_has.size(); ++t)
      if ((m_has[t][b] != 0) == is_there)
        result.push_back(t);
    return result;
  }

  Eigen::MatrixXd block(std::size_t b, const std::vector<std::size_t>& trees) const
  {
    Eigen::MatrixXd z(m_features.size(b), static_cast<Eigen::Index>(trees.size()));
    for (std::size_t i = 0; i < trees.size(); ++i)
      z.col(static_cast<Eigen::Index>(i)) = m_values.col(static_cast<Eigen::Index>(trees[i]))
                                                .segment(m_features.first(b), m_features.size(b));
    return z;
  }

  Eigen::MatrixXd with_floor(double fraction) const
  {
    const Eigen::Index n = m_covariance.rows();
    return m_covariance + fraction * m_covariance.trace() / static_cast<double>(n) *
                              Eigen::MatrixXd::Identity(n, n);
  }

  static Eigen::MatrixXd part(const Eigen::MatrixXd& a,
                              const std::vector<std::size_t>& rows,
                              const std::vector<std::size_t>& columns)
  {
    Eigen::MatrixXd result(static_cast<Eigen::Index>(rows.size()),
                           static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < columns.size(); ++j)
        result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            a(static_cast<Eigen::Index>(rows[i]), static_cast<Eigen::Index>(columns[j]));
    return result;
  }

  /// Completes the deviations of a block. `covariance` is empty in the first step: unknown
  /// deviations are 0 then.
  Completed_block complete(std::size_t b, const Eigen::MatrixXd& covariance) const
  {
    const auto n = static_cast<Eigen::Index>(m_has.size());
    const std::vector<std::size_t> known = trees_with(b), open = trees_with(b, false);
    Completed_block result{Eigen::MatrixXd::Zero(m_features.size(b), n),
                           Eigen::VectorXd(),
                           Eigen::MatrixXd::Zero(n, n)};
    Eigen::MatrixXd z = block(b, known);
    const bool is_first = covariance.size() == 0;
    Eigen::MatrixXd inverse;
    if (is_first || open.empty())
      result.mean = z.rowwise().mean();
    else {
      inverse = internal::inverse_of_symmetric(part(covariance, known, known));
      const Eigen::VectorXd weight = inverse.rowwise().sum();
      result.mean = z * weight / weight.sum(); // generalised least squares
    }
    z.colwise() -= result.mean;
    for (std::size_t i = 0; i < known.size(); ++i)
      result.deviations.col(static_cast<Eigen::Index>(known[i])) =
          z.col(static_cast<Eigen::Index>(i));
    if (is_first || open.empty())
      return result;
    const Eigen::MatrixXd across = part(covariance, known, open);
    const Eigen::MatrixXd from_known = inverse * across;
    const Eigen::MatrixXd expected = z * from_known;
    const double scale =
        (z * inverse).cwiseProduct(z).sum() / std::max(1.0, static_cast<double>(known.size()) - 1);
    const Eigen::MatrixXd rest =
        scale * (part(covariance, open, open) - across.transpose() * from_known);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i), to = static_cast<Eigen::Index>(open[i]);
      result.deviations.col(to) = expected.col(row);
      for (std::size_t j = 0; j < open.size(); ++j)
        result.uncertainty(to, static_cast<Eigen::Index>(open[j])) =
            rest(row, static_cast<Eigen::Index>(j));
    }
    return result;
  }

  template <class ConcurrencyTag>
  void iterate()
  {
    constexpr std::size_t number_of_parts = 32; // fixed, so that sums have one order
    const auto n = static_cast<Eigen::Index>(m_has.size());
    const std::size_t blocks = m_features.number_of_blocks();
    const bool is_first = m_covariance.size() == 0;
    Eigen::MatrixXd covariance, inverse = Eigen::MatrixXd::Identity(n, n);
    if (!is_first) {
      covariance = with_floor(rounding);
      inverse = internal::inverse_of_symmetric(with_floor(own_fraction));
    }
    std::vector<Eigen::MatrixXd> sums(number_of_parts, Eigen::MatrixXd::Zero(n, n));
    pcs::internal::for_each_index<ConcurrencyTag>(
        number_of_parts,
        [&](std::size_t p) {
          for (std::size_t b = p * blocks / number_of_parts; b < (p + 1) * blocks / number_of_parts;
               ++b) {
            if (!(m_variance[b] > 0))
              continue;
            const Completed_block c = complete(b, covariance);
            const double size = (c.deviations * inverse).cwiseProduct(c.deviations).sum();
            const auto known = static_cast<double>(trees_with(b).size());
            m_weight[b] = size > 0 ? known / static_cast<double>(n) / size : 0;
            sums[p] += m_weight[b] * (c.deviations.transpose() * c.deviations + c.uncertainty);
          }
        },
        1);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
    for (const Eigen::MatrixXd& s : sums)
      sum += s;
    const double trace = sum.trace();
    m_covariance = trace > 0 ? Eigen::MatrixXd(sum * (static_cast<double>(n) / trace))
                             : Eigen::MatrixXd::Zero(n, n);
  }

  void find_deviations()
  {
    m_deviations.setZero(m_values.rows(), m_values.cols());
    for (std::size_t b = 0; b < m_features.number_of_blocks(); ++b) {
      const std::vector<std::size_t> known = trees_with(b);
      if (known.empty())
        continue;
      auto mean = m_mean.segment(m_features.first(b), m_features.size(b));
      if (!(m_variance[b] > 0)) {
        mean = block(b, known).rowwise().mean();
        continue;
      }
      const Completed_block c = complete(b, with_floor(rounding));
      const Eigen::VectorXd center = c.deviations.rowwise().mean();
      mean = c.mean + center;
      m_deviations.middleRows(m_features.first(b), m_features.size(b)) =
          c.deviations.colwise() - center;
    }
  }

  const Tree_features& m_features;
  const Eigen::MatrixXd& m_values;
  const std::vector<std::vector<char>>& m_has;
  Eigen::MatrixXd m_covariance, m_deviations;
  Eigen::VectorXd m_mean;
  std::vector<double> m_weight, m_variance;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_TREE_COVARIANCE_H
