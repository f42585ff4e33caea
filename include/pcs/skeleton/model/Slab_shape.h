// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Mean and principal directions of a horizontal slab of points.

#ifndef PCS_SKELETON_MODEL_SLAB_SHAPE_H
#define PCS_SKELETON_MODEL_SLAB_SHAPE_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Mean of a set of points, and standard deviations perpendicular to `up`.
struct Slab_shape
{
  Vec3 mean = Vec3::Zero();
  Vec3 along = Vec3::UnitX();   ///< direction of the largest spread, towards the higher points
  double length = 0, width = 0; ///< standard deviations along and across it [L]

  Slab_shape(const Scan& scan, const std::vector<Index>& points, const Vec3& up)
  {
    for (const Index i : points)
      mean += scan.points[i];
    mean /= double(points.size());
    const Vec3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const Index i : points) {
      const Vec3 d = scan.points[i] - mean;
      const Eigen::Vector2d q(d.dot(e1), d.dot(e2));
      covariance += q * q.transpose();
    }
    const auto eigen = linear_algebra::symmetric_eigen<2>(covariance / double(points.size()));
    const Eigen::Vector2d v = eigen.vectors.col(1);
    along = v(0) * e1 + v(1) * e2;
    double rise = 0;
    for (const Index i : points)
      rise += (scan.points[i] - mean).dot(along) * (scan.points[i] - mean).dot(up);
    if (rise < 0)
      along = -along;
    width = std::sqrt(std::max(0.0, eigen.values(0)));
    length = std::sqrt(std::max(0.0, eigen.values(1)));
  }
};

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_SLAB_SHAPE_H
