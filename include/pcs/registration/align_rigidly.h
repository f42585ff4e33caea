// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Rigid alignment of two clouds: by pairs of points, and by soft correspondences.

#ifndef PCS_REGISTRATION_ALIGN_RIGIDLY_H
#define PCS_REGISTRATION_ALIGN_RIGIDLY_H

#include <pcs/core/rotations.h>
#include <pcs/registration/soft_matches.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace registration {

/// The map `x -> r x + t`.
struct Rigid_motion
{
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  Vec3 t = Vec3::Zero(); ///< [L]

  Vec3 operator()(const Vec3& x) const { return r * x + t; }
};

/// Returns the rigid motion with the least weighted sum of squares. Collinear points are not turned
/// about their line.
inline Rigid_motion fit_motion(const std::vector<Vec3>& source,
                               const std::vector<Vec3>& target,
                               const std::vector<double>& weight)
{
  Vec3 cx = Vec3::Zero(), cy = Vec3::Zero();
  double total = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    cx += weight[i] * source[i];
    cy += weight[i] * target[i];
    total += weight[i];
  }
  Rigid_motion motion;
  if (!(total > 0))
    return motion;
  cx /= total;
  cy /= total;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i)
    covariance += weight[i] * (target[i] - cy) * (source[i] - cx).transpose();
  constexpr int most_steps = 200; // after a few, the convergence is quadratic
  Quaternion q = Quaternion::Identity();
  for (int k = 0; k < most_steps; ++k) {
    const Vec3 turn = newton_turn(covariance * q.toRotationMatrix().transpose(), 0);
    q = (rotation_exp(turn) * q).normalized();
    if (turn.squaredNorm() < 1e-28)
      break;
  }
  motion.r = q.toRotationMatrix();
  motion.t = cy - motion.r * cx;
  return motion;
}

/// Returns the mean squared distance of the points of one cloud from those of another along one
/// coordinate. [L^2]
inline double mean_variance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  Vec3 ca = Vec3::Zero(), cb = Vec3::Zero();
  for (const Vec3& p : a)
    ca += p / static_cast<double>(a.size());
  for (const Vec3& p : b)
    cb += p / static_cast<double>(b.size());
  double sum = (ca - cb).squaredNorm();
  for (const Vec3& p : a)
    sum += (p - ca).squaredNorm() / static_cast<double>(a.size());
  for (const Vec3& p : b)
    sum += (p - cb).squaredNorm() / static_cast<double>(b.size());
  return sum / 3;
}

/// Returns the volume of the bounding box of two clouds; no side counts as shorter than a tenth of
/// the diagonal. [L^3]
inline double common_volume(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  Vec3 low = a.front(), high = low;
  for (const auto* points : {&a, &b})
    for (const Vec3& p : *points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  const Vec3 size = (high - low).cwiseMax(0.1 * (high - low).norm());
  return size.x() * size.y() * size.z();
}

struct Alignment_options
{
  double last_deviation = 0; ///< standard deviation at which the iterations end [L]
  double tolerance = 0;      ///< largest step at which the iterations end [L]
  double outlier_share = 0.1;
  std::size_t number_of_iterations = 60;
};

/*!
  Rigid coherent point drift: alternates soft matches and the rigid motion that fits them, while the
  variance of the matches decreases.

  \param source its points are moved
  \param go_on `go_on(iteration)` returns `false` to stop
*/
template <class ConcurrencyTag, class GoOn>
Rigid_motion align_rigidly(std::vector<Vec3>& source,
                           const std::vector<Vec3>& target,
                           const Alignment_options& options,
                           const GoOn& go_on)
{
  Rigid_motion total;
  Soft_matches matches;
  const double volume = common_volume(source, target);
  double variance = mean_variance(source, target);
  const double last = options.last_deviation * options.last_deviation;
  for (std::size_t k = 0; k < options.number_of_iterations && go_on(k); ++k) {
    find_soft_matches<ConcurrencyTag>(source,
                                      target,
                                      variance,
                                      options.outlier_share,
                                      volume,
                                      matches);
    const Rigid_motion step = fit_motion(source, matches.target, matches.weight);
    total = {step.r * total.r, step(total.t)};
    double moved = 0;
    for (Vec3& p : source) {
      const Vec3 before = p;
      p = step(p);
      moved = std::max(moved, (p - before).norm());
    }
    if (moved < options.tolerance && variance <= last)
      break;
    variance = std::max(last, std::min(0.9 * variance, std::max(matches.variance, 0.5 * variance)));
  }
  return total;
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_ALIGN_RIGIDLY_H
