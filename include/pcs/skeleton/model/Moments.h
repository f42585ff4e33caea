// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// First and second moments of points.

#ifndef PCS_SKELETON_MODEL_MOMENTS_H
#define PCS_SKELETON_MODEL_MOMENTS_H

#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

namespace pcs {
namespace skeleton {

/// Count, sum, and sum of outer products of points, which should lie near the origin.
struct Moments
{
  double count = 0;
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();

  void add(const Vec3& p)
  {
    count += 1;
    sum += p;
    square += p * p.transpose();
  }
  void add(const Moments& other)
  {
    count += other.count;
    sum += other.sum;
    square += other.square;
  }
  Vec3 mean() const { return sum / count; }
  Eigen::Matrix3d covariance() const { return square / count - mean() * mean().transpose(); }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_MOMENTS_H
