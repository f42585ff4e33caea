// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Other registrations, to compare with: rigid iterative closest points, and coherent point drift.

#ifndef PCS_BENCHMARK_QUALITY_COHERENT_POINT_DRIFT_H
#define PCS_BENCHMARK_QUALITY_COHERENT_POINT_DRIFT_H

#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/registration/align_rigidly.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs_bench {

using Points = std::vector<Eigen::Vector3d>;

/// Rigid iterative closest points (Besl and McKay 1992), trimmed (Chetverikov 2002): the share
/// `kept` of the pairs with the shortest distances counts.
inline Points rigid_icp(Points source, const Points& target, double kept)
{
  const pcs::neighborhood::Nearest_neighbors tree(target);
  std::vector<pcs::neighborhood::Nearest_neighbors::Neighbor> nearest;
  std::vector<double> distance(source.size()), weight(source.size());
  Points matched(source.size());
  for (int iteration = 0; iteration < 60; ++iteration) {
    for (std::size_t i = 0; i < source.size(); ++i) {
      tree(source[i], 1, nearest);
      matched[i] = target[nearest.front().index];
      distance[i] = nearest.front().squared_distance;
    }
    std::vector<double> sorted = distance;
    std::sort(sorted.begin(), sorted.end());
    const double limit = sorted[static_cast<std::size_t>(kept * double(sorted.size() - 1))];
    for (std::size_t i = 0; i < source.size(); ++i)
      weight[i] = distance[i] <= limit ? 1 : 0;
    const auto motion = pcs::registration::fit_motion(source, matched, weight);
    for (auto& p : source)
      p = motion(p);
  }
  return source;
}

/*!
  Nonrigid coherent point drift (Myronenko and Song 2010, figure 4) on subsets, with its direct
  solution and the published parameters `beta = 2`, `lambda = 3` for normalised clouds. The
  displacement is then evaluated at all points of `source`.
*/
inline Points coherent_point_drift(const Points& source,
                                   const Points& source_subset,
                                   const Points& target_subset,
                                   double outlier_share)
{
  using Matrix = Eigen::MatrixXd;
  constexpr double beta = 2, lambda = 3, pi = 3.14159265358979323846;
  constexpr int most_iterations = 150;
  const auto m = static_cast<Eigen::Index>(source_subset.size());
  const auto n = static_cast<Eigen::Index>(target_subset.size());
  Matrix y(m, 3), x(n, 3);
  for (Eigen::Index i = 0; i < m; ++i)
    y.row(i) = source_subset[static_cast<std::size_t>(i)].transpose();
  for (Eigen::Index j = 0; j < n; ++j)
    x.row(j) = target_subset[static_cast<std::size_t>(j)].transpose();
  const Eigen::RowVector3d mean_y = y.colwise().mean(), mean_x = x.colwise().mean();
  y.rowwise() -= mean_y;
  x.rowwise() -= mean_x;
  const double size_y = std::sqrt(y.squaredNorm() / double(m));
  const double size_x = std::sqrt(x.squaredNorm() / double(n));
  y /= size_y;
  x /= size_x;
  const auto kernel = [&](const Eigen::RowVector3d& a, const Eigen::RowVector3d& b) {
    return std::exp(-(a - b).squaredNorm() / (2 * beta * beta));
  };
  Matrix g(m, m);
  for (Eigen::Index i = 0; i < m; ++i)
    for (Eigen::Index j = 0; j < m; ++j)
      g(i, j) = kernel(y.row(i), y.row(j));
  Matrix w = Matrix::Zero(m, 3), t = y, p(m, n);
  double variance = 0;
  for (Eigen::Index j = 0; j < n; ++j)
    variance += (y.rowwise() - x.row(j)).squaredNorm() / (3.0 * double(m) * double(n));
  for (int iteration = 0; iteration < most_iterations && variance > 1e-8; ++iteration) {
    const double c = std::pow(2 * pi * variance, 1.5) * outlier_share / (1 - outlier_share) *
                     double(m) / double(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      p.col(j) = (-(t.rowwise() - x.row(j)).rowwise().squaredNorm() / (2 * variance)).array().exp();
      p.col(j) /= std::max(p.col(j).sum() + c, 1e-300);
    }
    const Eigen::VectorXd p1 = p.rowwise().sum(), pt1 = p.colwise().sum().transpose();
    const Matrix px = p * x;
    Matrix a = p1.asDiagonal() * g;
    a.diagonal().array() += lambda * variance;
    w = a.partialPivLu().solve(px - p1.asDiagonal() * y);
    t = y + g * w;
    const double xx = (pt1.array() * x.rowwise().squaredNorm().array()).sum();
    const double yy = (p1.array() * t.rowwise().squaredNorm().array()).sum();
    const double before = variance;
    variance = std::abs(xx - 2 * (px.array() * t.array()).sum() + yy) / (3 * p1.sum());
    if (std::abs(before - variance) < 1e-6 * before)
      break;
  }
  Points result;
  for (const auto& point : source) {
    const Eigen::RowVector3d q = (point.transpose() - mean_y) / size_y;
    Eigen::RowVector3d moved = q;
    for (Eigen::Index i = 0; i < m; ++i)
      moved += kernel(q, y.row(i)) * w.row(i);
    result.push_back((moved * size_x + mean_x).transpose());
  }
  return result;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_COHERENT_POINT_DRIFT_H
