// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Normals and principal curvatures of a scan by osculating circles.

#ifndef PCS_SKELETON_SLICES_PRINCIPAL_CURVATURES_H
#define PCS_SKELETON_SLICES_PRINCIPAL_CURVATURES_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Number of neighbours for a normal and the curvatures, as published [Aiteanu 2022] [count].
constexpr std::size_t curvature_neighbors = 25;

/// The surface at a point. The sign of the normal is arbitrary; it determines the sign of `k1`.
struct Surface_frame
{
  Vec3 normal = Vec3::UnitZ();
  Vec3 e1 = Vec3::UnitX(); ///< direction of the larger curvature: around the branch
  Vec3 e2 = Vec3::UnitY(); ///< along the branch
  double k1 = 0, k2 = 0;   ///< |k1| >= |k2| [1/L]
};

namespace internal {

inline Vec3 normal_of(const std::vector<Vec3>& points)
{
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points)
    mean += p;
  mean /= double(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points)
    covariance += (p - mean) * (p - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Vec3 n = solver.eigenvectors().col(0);
  return n.allFinite() && n.norm() > 0.5 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
}

} // namespace internal

/// Returns the mean unit normals of the points of the scan, null where all given normals of a point
/// are null. Normals of opposite signs do not cancel each other.
inline std::vector<Vec3> normals_of_scan(const Scan& scan, const std::vector<Vec3>& of_input)
{
  std::vector<Vec3> normals(of_input.empty() ? 0 : scan.size(), Vec3::Zero());
  for (std::size_t i = 0; i < of_input.size(); ++i) {
    const double length = of_input[i].stableNorm();
    if (!(length > 0) || !std::isfinite(length))
      continue;
    const Vec3 normal = scan.frame.direction_to_local(of_input[i] / length);
    Vec3& sum = normals[scan.point_of_input[i]];
    sum += sum.dot(normal) < 0 ? Vec3(-normal) : normal;
  }
  for (Vec3& normal : normals)
    normal.stableNormalize();
  return normals;
}

/*!
  Estimates the surface at every point. The normal is that of `given`, or, if `given` is empty or
  null at the point, the third axis of a principal component analysis. The Weingarten matrix is a
  least-squares fit of Euler's formula to the normal curvatures of the circles that are tangent to
  the surface at the point and pass through a neighbour. The centre of curvature, `point + normal /
  k1`, does not depend on the sign of the normal. O(n k log n).
*/
template <class ConcurrencyTag>
std::vector<Surface_frame> principal_curvatures(const Scan& scan,
                                                const std::vector<Vec3>& given = {})
{
  const std::size_t n = scan.size();
  std::vector<Surface_frame> frames(n);
  std::vector<Index> lists(n * curvature_neighbors, none);
  pcs::internal::for_each_block<ConcurrencyTag>(n, 512, [&](std::size_t begin, std::size_t end) {
    std::vector<neighborhood::Nearest_neighbors::Neighbor> found;
    std::vector<Vec3> points;
    for (std::size_t i = begin; i < end; ++i) {
      (*scan.search)(scan.points[i], curvature_neighbors + 1, found);
      points.clear();
      std::size_t count = 0;
      for (const auto& f : found) {
        points.push_back(scan.points[f.index]);
        if (f.index != i && count < curvature_neighbors)
          lists[i * curvature_neighbors + count++] = f.index;
      }
      const bool is_given = !given.empty() && given[i] != Vec3::Zero();
      frames[i].normal = is_given ? given[i] : internal::normal_of(points);
    }
  });
  std::vector<Vec3> normals(n);
  for (std::size_t i = 0; i < n; ++i)
    normals[i] = frames[i].normal;
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    Surface_frame& frame = frames[i];
    const Vec3 x = frame.normal.unitOrthogonal(), y = frame.normal.cross(x);
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < curvature_neighbors; ++k) {
      const Index j = lists[i * curvature_neighbors + k];
      if (j == none)
        break;
      const Vec3 d = scan.points[j] - scan.points[i];
      Vec3 m = normals[j];
      if (m.dot(frame.normal) < 0)
        m = -m;
      const double px = d.dot(x), py = d.dot(y), across = std::hypot(px, py);
      if (!(across > 0))
        continue;
      const double c = px / across, s = py / across;
      const double in_plane = c * m.dot(x) + s * m.dot(y);
      const double curvature = -in_plane / (std::hypot(in_plane, m.dot(frame.normal)) * across);
      const Eigen::Vector3d f(c * c, 2 * c * s, s * s);
      a += f * f.transpose();
      b += f * curvature;
    }
    Eigen::Vector3d w;
    if (!linear_algebra::solve_symmetric(a, b, w))
      return;
    Eigen::Matrix2d weingarten;
    weingarten << w(0), w(1), w(1), w(2);
    const auto eigen = linear_algebra::symmetric_eigen<2>(weingarten);
    const Eigen::Vector2d k = eigen.values;
    const int large = std::abs(k(0)) > std::abs(k(1)) ? 0 : 1;
    const Eigen::Vector2d u = eigen.vectors.col(large);
    frame.k1 = k(large);
    frame.k2 = k(1 - large);
    frame.e1 = u(0) * x + u(1) * y;
    frame.e2 = frame.normal.cross(frame.e1);
  });
  return frames;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_PRINCIPAL_CURVATURES_H
