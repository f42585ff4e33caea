// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Geometric median and Frechet mean of rotations.

#ifndef PCS_SHAPE_SPACE_EMBEDDING_MEAN_ROTATION_H
#define PCS_SHAPE_SPACE_EMBEDDING_MEAN_ROTATION_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

/// Returns the rotation with the least sum of squared chords, the initial value of both means. The
/// signs of the quaternions have no influence.
inline Quaternion chordal_mean(const std::vector<Quaternion>& q, const std::vector<double>& w)
{
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < q.size(); ++i)
    sum += w[i] * q[i].coeffs() * q[i].coeffs().transpose();
  const auto eigen = linear_algebra::symmetric_eigen<4>(sum);
  Quaternion mean;
  mean.coeffs() = eigen.vectors.col(3);
  if (mean.w() < 0)
    mean.coeffs() = -mean.coeffs();
  mean.normalize();
  return mean;
}

inline double
sum_of_angles(const Quaternion& at, const std::vector<Quaternion>& q, const std::vector<double>& w)
{
  double sum = 0;
  for (std::size_t i = 0; i < q.size(); ++i)
    sum += w[i] * angle_between(at, q[i]);
  return sum;
}

/// Steps towards the L1 mean from a rotation that is no data point. If the Newton step cannot be
/// computed, it is the Weiszfeld step.
struct L1_step
{
  Vec3 newton = Vec3::Zero(), weiszfeld = Vec3::Zero();
  double gradient = 0; ///< length of the sum of weighted unit vectors
};

inline L1_step
l1_step(const Quaternion& at, const std::vector<Quaternion>& q, const std::vector<double>& w)
{
  L1_step step;
  Vec3 pull = Vec3::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
  double sum = 0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Vec3 v = rotation_log(at.conjugate() * q[i]);
    const double angle = v.norm();
    if (!(angle > 1e-14) || !(w[i] > 0))
      continue;
    const Vec3 u = v / angle;
    pull += w[i] * u;
    sum += w[i] / angle;
    // second derivative of the distance on a sphere of radius 2
    curvature += w[i] * 0.5 / std::tan(0.5 * std::min(angle, 3.1)) *
                 (Eigen::Matrix3d::Identity() - u * u.transpose());
  }
  step.gradient = pull.norm();
  if (!(sum > 0))
    return step;
  step.weiszfeld = pull / sum;
  Vec3 newton;
  const bool is_solved = linear_algebra::solve_symmetric(curvature, pull, newton) &&
                         (curvature * newton - pull).norm() <= 1e-6 * step.gradient;
  step.newton = is_solved ? newton : step.weiszfeld;
  return step;
}

/// A rotation and its sum of weighted angles to others. [rad]
struct Rotation_and_cost
{
  Quaternion q;
  double cost;
};

/// Replaces `best` by the data point of least cost if this cost is lower. Two data points of equal
/// cost are the ends of an arc of minima, of which the middle is taken.
inline void try_data_points(const std::vector<Quaternion>& q,
                            const std::vector<double>& w,
                            Rotation_and_cost& best)
{
  std::vector<Quaternion> ends;
  std::vector<double> sums(q.size());
  double least_at_data = best.cost * (1 + 1e-12);
  for (std::size_t i = 0; i < q.size(); ++i)
    if (w[i] > 0) {
      sums[i] = sum_of_angles(q[i], q, w);
      least_at_data = std::min(least_at_data, sums[i]);
    }
  for (std::size_t i = 0; i < q.size(); ++i)
    if (w[i] > 0 && sums[i] <= least_at_data * (1 + 1e-12))
      ends.push_back(q[i]);
  if (ends.empty())
    return;
  const Quaternion middle = chordal_mean(ends, std::vector<double>(ends.size(), 1));
  const double sum = sum_of_angles(middle, q, w);
  if (sum <= best.cost * (1 + 1e-12))
    best = {sum <= least_at_data * (1 + 1e-12) ? middle : ends.front(),
            std::min(sum, least_at_data)};
  else if (least_at_data <= best.cost)
    best = {ends.front(), least_at_data};
}

/// Moves `best` by one step of Newton or Weiszfeld, halved until the cost decreases. Returns
/// whether another step may improve it. At a data point, the weight of
/// this point is first subtracted from the length of the gradient.
inline bool descend(const std::vector<Quaternion>& q,
                    const std::vector<double>& w,
                    double total_weight,
                    Rotation_and_cost& best)
{
  constexpr int number_of_attempts = 40;
  double weight_here = 0;
  for (std::size_t i = 0; i < q.size(); ++i)
    if (angle_between(best.q, q[i]) <= 1e-14)
      weight_here += w[i];
  const L1_step step = l1_step(best.q, q, w);
  if (step.gradient <= std::max(weight_here, 1e-13 * total_weight))
    return false;
  Vec3 u = weight_here > 0 ? Vec3(step.weiszfeld * (1 - weight_here / step.gradient)) : step.newton;
  bool is_better = false;
  for (int attempt = 0; attempt < number_of_attempts && !is_better; ++attempt) {
    if (attempt == 1 && !(weight_here > 0))
      u = step.weiszfeld;
    else if (attempt > 1)
      u *= 0.5;
    Quaternion next = best.q * rotation_exp(u);
    next.normalize();
    const double sum = sum_of_angles(next, q, w);
    if (sum < best.cost) {
      is_better = true;
      best = {next, sum};
    }
  }
  return is_better && !(u.norm() < 1e-15);
}

} // namespace internal

/*!
  Returns the geometric median of rotations: the rotation with the least sum of weighted angles to
  all of them (R. Hartley, K. Aftab, J. Trumpf 2011). It is unique if they lie within a ball of
  radius pi/2. A data point is the median if the gradient of all others does not exceed its weight.
  Otherwise the median is found by Newton steps, or by Weiszfeld steps where these decrease the sum
  and Newton steps do not. If a whole arc has the least sum, its middle is returned. Rotations of
  weight 0 are ignored; `q` has at least one element.
*/
inline Quaternion l1_mean_rotation(const std::vector<Quaternion>& q, const std::vector<double>& w)
{
  constexpr std::size_t most_for_all_pairs = 128;
  constexpr int number_of_steps = 200;
  internal::Rotation_and_cost best{internal::chordal_mean(q, w), 0};
  best.cost = internal::sum_of_angles(best.q, q, w);
  double total = 0;
  for (const double weight : w)
    total += weight;
  if (!(total > 0) || best.cost <= 1e-12 * total)
    return best.q;
  if (q.size() <= most_for_all_pairs)
    internal::try_data_points(q, w, best);
  for (int k = 0; k < number_of_steps; ++k)
    if (!internal::descend(q, w, total, best))
      break;
  return best.q;
}

/// Returns the rotation with the least sum of weighted squared angles; weights may be negative if
/// their sum is positive.
inline Quaternion l2_mean_rotation(const std::vector<Quaternion>& q, const std::vector<double>& w)
{
  double total = 0;
  bool is_convex = true;
  std::size_t heaviest = 0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    total += w[i];
    is_convex = is_convex && w[i] >= 0;
    heaviest = w[i] > w[heaviest] ? i : heaviest;
  }
  if (!(total > 0))
    return internal::chordal_mean(q, std::vector<double>(q.size(), 1));
  Quaternion mean = is_convex ? internal::chordal_mean(q, w) : q[heaviest];
  constexpr int number_of_steps = 100;
  for (int k = 0; k < number_of_steps; ++k) {
    Vec3 pull = Vec3::Zero();
    for (std::size_t i = 0; i < q.size(); ++i)
      pull += w[i] / total * rotation_log(mean.conjugate() * q[i]);
    if (!(pull.norm() > 1e-15))
      break;
    mean = mean * rotation_exp(pull);
    mean.normalize();
  }
  return mean;
}

/// Returns the middle of the interval of weighted medians; 0 without weights.
inline double weighted_median(const std::vector<double>& values, const std::vector<double>& w)
{
  std::vector<std::size_t> order;
  double total = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (w[i] > 0) {
      order.push_back(i);
      total += w[i];
    }
  if (order.empty())
    return 0;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return values[a] != values[b] ? values[a] < values[b] : a < b;
  });
  double sum = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    sum += w[order[k]];
    if (std::abs(sum - 0.5 * total) <= 1e-12 * total && k + 1 < order.size())
      return 0.5 * (values[order[k]] + values[order[k + 1]]);
    if (sum > 0.5 * total)
      return values[order[k]];
  }
  return values[order.back()];
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_MEAN_ROTATION_H
