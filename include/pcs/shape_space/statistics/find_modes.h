// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Principal modes of variation in the tangent space at the mean.

#ifndef PCS_SHAPE_SPACE_STATISTICS_FIND_MODES_H
#define PCS_SHAPE_SPACE_STATISTICS_FIND_MODES_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>
#include <pcs/shape_space/statistics/Tangent_space.h>
#include <pcs/shape_space/statistics/Tree_covariance.h>
#include <pcs/shape_space/statistics/Tree_features.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

struct Principal_scores
{
  Eigen::MatrixXd vectors; ///< n x k, columns of unit length
  Eigen::VectorXd shares;  ///< k, fractions of the trace
};

/// Returns the eigenvectors of the centered covariance matrix of the trees, by decreasing
/// eigenvalue. Eigenvalues within rounding of 0 are left out.
inline Principal_scores principal_scores(const Eigen::MatrixXd& covariance)
{
  const Eigen::Index n = covariance.rows();
  const Eigen::MatrixXd center =
      Eigen::MatrixXd::Identity(n, n) - Eigen::MatrixXd::Constant(n, n, 1 / static_cast<double>(n));
  const auto eigen = linear_algebra::symmetric_eigen<Eigen::Dynamic>(center * covariance * center);
  Principal_scores result;
  const double largest = n > 0 ? std::max(0.0, eigen.values[n - 1]) : 0;
  Eigen::Index k = 0;
  while (k < n - 1 && largest > 0 && eigen.values[n - 1 - k] > 1e-12 * largest)
    ++k;
  result.vectors = eigen.vectors.rightCols(k).rowwise().reverse();
  result.shares = eigen.values.tail(k).reverse() / std::max(1e-300, eigen.values.sum());
  return result;
}

/// Scores of a tree, and its distances `distance[k]` from the space of the first k modes. [-]
struct Mode_fit
{
  Eigen::VectorXd scores;
  std::vector<double> distance;
};

/// Fits the scores of a tree by weighted least squares over the blocks of features that the tree
/// has. Modified Gram-Schmidt orthogonalization gives the distances for all numbers of modes.
inline Mode_fit fit_modes(const Tree_features& features,
                          const Mode_features& modes,
                          const Eigen::VectorXd& values,
                          const std::vector<char>& has)
{
  Eigen::VectorXd root = Eigen::VectorXd::Zero(values.size());
  double scale = 0; // expected squared distance without modes
  for (std::size_t b = 0; b < features.number_of_blocks(); ++b)
    if (has[b]) {
      root.segment(features.first(b), features.size(b)).setConstant(std::sqrt(modes.weight[b]));
      scale += modes.weight[b] * modes.variance[b];
    }
  Eigen::VectorXd rest = root.cwiseProduct(values - modes.mean);
  const Eigen::Index k = modes.directions.cols();
  Eigen::MatrixXd q = root.asDiagonal() * modes.directions, r = Eigen::MatrixXd::Zero(k, k);
  Eigen::VectorXd c = Eigen::VectorXd::Zero(k);
  Mode_fit result;
  double apart = 0; // distance if the trees have no spread
  if (!(scale > 0))
    for (std::size_t b = 0; b < features.number_of_blocks(); ++b)
      if (has[b] && (values - modes.mean).segment(features.first(b), features.size(b)).norm() >
                        modes.least_deviation)
        apart = std::numeric_limits<double>::infinity();
  const auto add_distance = [&] {
    result.distance.push_back(scale > 0 ? std::sqrt(rest.squaredNorm() / scale) : apart);
  };
  add_distance();
  for (Eigen::Index j = 0; j < k; ++j) {
    const double whole = q.col(j).norm();
    for (int pass = 0; pass < 2; ++pass)
      for (Eigen::Index i = 0; i < j; ++i) {
        const double d = q.col(i).dot(q.col(j));
        q.col(j) -= d * q.col(i);
        r(i, j) += d;
      }
    r(j, j) = q.col(j).norm();
    if (r(j, j) > 1e-8 * whole) { // otherwise, it is a combination of previous modes
      q.col(j) /= r(j, j);
      for (int pass = 0; pass < 2; ++pass) {
        const double d = q.col(j).dot(rest);
        rest -= d * q.col(j);
        c[j] += d;
      }
    } else {
      q.col(j).setZero();
      r(j, j) = 0;
    }
    add_distance();
  }
  result.scores = Eigen::VectorXd::Zero(k);
  for (Eigen::Index j = k; j-- > 0;) {
    double sum = c[j];
    for (Eigen::Index i = j + 1; i < k; ++i)
      sum -= r(j, i) * result.scores[i];
    result.scores[j] = r(j, j) > 0 ? sum / r(j, j) : 0;
  }
  return result;
}

/// Computes the modes in the space of features, by regression of the deviations of the trees on
/// their scores.
inline void set_features(const Tree_features& features,
                         const Tree_covariance& covariance,
                         const Eigen::MatrixXd& scores,
                         double least_deviation,
                         Mode_features& modes)
{
  modes.least_deviation = least_deviation;
  modes.mean = covariance.mean();
  modes.directions =
      covariance.deviations() * scores / std::max(1.0, static_cast<double>(scores.rows() - 1));
  modes.weight.clear();
  modes.variance.clear();
  for (std::size_t b = 0; b < features.number_of_blocks(); ++b) {
    modes.weight.push_back(covariance.weight(b));
    modes.variance.push_back(covariance.variance(b));
  }
}

/// Tangent vectors and features of trees, as columns.
struct Mode_inputs
{
  Eigen::MatrixXd tangents; ///< centered
  Eigen::VectorXd center;
  Eigen::MatrixXd values;             ///< features of the trees
  std::vector<std::vector<char>> has; ///< which branches each tree has
};

template <class ConcurrencyTag>
Mode_inputs mode_inputs(const std::vector<const Orl_coordinates*>& trees,
                        const Tangent_space& tangent,
                        const Tree_features& features)
{
  const auto n = static_cast<Eigen::Index>(trees.size());
  Mode_inputs in;
  in.tangents.resize(tangent.dimension(), n);
  in.values.resize(features.dimension(), n);
  in.has.resize(trees.size());
  pcs::internal::for_each_index<ConcurrencyTag>(
      trees.size(),
      [&](std::size_t t) {
        in.tangents.col(static_cast<Eigen::Index>(t)) = tangent.log(*trees[t]);
        in.values.col(static_cast<Eigen::Index>(t)) = features(*trees[t], in.has[t]);
      },
      1);
  in.center = in.tangents.rowwise().mean();
  in.tangents.colwise() -= in.center;
  return in;
}

/// Computes directions, deviations, scores and fractions of the variance of at most `most` modes by
/// regression of tangent vectors on the principal scores. Modes with a deviation of at most `least`
/// are left out.
inline void set_directions(const Eigen::MatrixXd& tangents,
                           const Principal_scores& principal,
                           std::size_t most,
                           double least,
                           Modes_of_variation& result)
{
  const Eigen::Index n = tangents.cols();
  const double divisor = std::sqrt(std::max(1.0, static_cast<double>(n - 1)));
  Eigen::MatrixXd directions(tangents.rows(), 0);
  std::vector<double> deviations, shares;
  result.scores.resize(n, 0);
  for (Eigen::Index k = 0; k < principal.shares.size() && deviations.size() < most; ++k) {
    Eigen::VectorXd score = principal.vectors.col(k) * divisor;
    Eigen::VectorXd u = tangents * score / (divisor * divisor);
    const double deviation = u.norm();
    if (!(deviation > least))
      continue;
    u /= deviation;
    Eigen::Index largest = 0;
    u.cwiseAbs().maxCoeff(&largest);
    if (u[largest] < 0) {
      u = -u;
      score = -score;
    }
    const auto i = static_cast<Eigen::Index>(deviations.size());
    directions.conservativeResize(Eigen::NoChange, i + 1);
    result.scores.conservativeResize(Eigen::NoChange, i + 1);
    directions.col(i) = u;
    result.scores.col(i) = score;
    deviations.push_back(deviation);
    shares.push_back(principal.shares[k]);
  }
  result.directions = std::move(directions);
  result.deviations =
      Eigen::Map<Eigen::VectorXd>(deviations.data(), static_cast<Eigen::Index>(deviations.size()));
  result.shares =
      Eigen::Map<Eigen::VectorXd>(shares.data(), static_cast<Eigen::Index>(shares.size()));
}

/// Returns the distances of tree `t` from the modes of all other trees, by number of modes. [-]
inline std::vector<double> left_out_distances(const Tree_features& features,
                                              const Tree_covariance& covariance,
                                              const Mode_inputs& in,
                                              std::size_t t,
                                              std::size_t most,
                                              double least)
{
  const Eigen::Index n = in.values.cols();
  std::vector<Eigen::Index> others;
  std::vector<std::vector<char>> of_others;
  for (std::size_t i = 0; i < in.has.size(); ++i)
    if (i != t) {
      others.push_back(static_cast<Eigen::Index>(i));
      of_others.push_back(in.has[i]);
    }
  Eigen::MatrixXd x(in.values.rows(), n - 1), start(n - 1, n - 1);
  for (Eigen::Index i = 0; i < n - 1; ++i) {
    x.col(i) = in.values.col(others[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < n - 1; ++j)
      start(i, j) = covariance.covariance()(others[static_cast<std::size_t>(i)],
                                            others[static_cast<std::size_t>(j)]);
  }
  const Tree_covariance rest(features, x, of_others, least, start, CGAL::Sequential_tag());
  const Principal_scores p = principal_scores(rest.covariance());
  const Eigen::Index k = std::min(p.vectors.cols(), static_cast<Eigen::Index>(most));
  Mode_features modes;
  set_features(features,
               rest,
               p.vectors.leftCols(k) * std::sqrt(static_cast<double>(n - 2)),
               least,
               modes);
  return fit_modes(features, modes, in.values.col(static_cast<Eigen::Index>(t)), in.has[t])
      .distance;
}

} // namespace internal

/*!
  Finds the principal modes of variation: at most `most`, fewer if the trees differ in fewer
  directions. The sign of a mode is such that its largest coordinate is positive.

  Scores are the principal components of the covariance (`Tree_covariance`) of the features of the
  trees (`Tree_features`). The features compare each branch among the trees that have it. With the
  centered tangent vectors `z_t` and the scores `s_tk` of `n` trees, a mode is the regression
  `u_k = sum_t s_tk z_t / (n - 1)` of the tangent vectors on the scores. A mode therefore also
  changes the lengths of branches that only some trees have. All modes together reproduce all trees.
  If every branch is equal in all trees that have it, this covariance is zero. The modes are then
  those of `Mode_inner_product::metric`, and `features.measure` has this value.
*/
template <class ConcurrencyTag>
Modes_of_variation find_modes(const Orl_layout& layout,
                              const std::vector<const Orl_coordinates*>& trees,
                              const Orl_weights& weights,
                              Orl_orientation orientation,
                              const Orl_coordinates& mean,
                              std::size_t most,
                              Mode_inner_product measure = Mode_inner_product::branches)
{
  const Tangent_space tangent(layout, mean, weights);
  const Tree_features features(layout, weights, orientation, mean, measure);
  const internal::Mode_inputs in = internal::mode_inputs<ConcurrencyTag>(trees, tangent, features);
  double size = 0;
  for (const double length : mean.length)
    size += length;
  const double least = 1e-9 * size; // smaller deviations are rounding
  const Tree_covariance covariance(features,
                                   in.values,
                                   in.has,
                                   least,
                                   Eigen::MatrixXd(),
                                   ConcurrencyTag());
  const internal::Principal_scores principal = internal::principal_scores(covariance.covariance());
  Modes_of_variation result;
  result.mean = mean;
  result.center = in.center;
  internal::set_directions(in.tangents, principal, most, least, result);
  if (result.deviations.size() == 0 && most > 0 && measure == Mode_inner_product::branches)
    return find_modes<ConcurrencyTag>(layout,
                                      trees,
                                      weights,
                                      orientation,
                                      mean,
                                      most,
                                      Mode_inner_product::metric);
  result.features.measure = measure;
  internal::set_features(features, covariance, result.scores, least, result.features);
  if (trees.size() > 2) {
    result.left_out.resize(trees.size());
    pcs::internal::for_each_index<ConcurrencyTag>(
        trees.size(),
        [&](std::size_t t) {
          result.left_out[t] =
              internal::left_out_distances(features, covariance, in, t, most, least);
        },
        1);
  }
  return result;
}

/// Returns the scores of the first `most` modes for a tree, by weighted least squares over its
/// branches, and the distance of the tree from the space of these modes.
inline Mode_coordinates project_on_modes(const Orl_layout& layout,
                                         const Orl_weights& weights,
                                         Orl_orientation orientation,
                                         const Modes_of_variation& modes,
                                         const Orl_coordinates& x,
                                         std::size_t most = none)
{
  const Tree_features features(layout, weights, orientation, modes.mean, modes.features.measure);
  std::vector<char> has;
  const Eigen::VectorXd values = features(x, has);
  Mode_features first = modes.features;
  if (most < modes.size())
    first.directions.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(most));
  internal::Mode_fit fit = internal::fit_modes(features, first, values, has);
  return {std::move(fit.scores), fit.distance.back()};
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_FIND_MODES_H
