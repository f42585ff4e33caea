// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Affine maps of samples and handles: nearest rotation, transformation of normals.

#ifndef PCS_DEFORMATION_MODEL_AFFINE_MAP_H
#define PCS_DEFORMATION_MODEL_AFFINE_MAP_H

#include <pcs/core/rotations.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace pcs {
namespace deformation {

/// The affine map `x -> a x + t` of one sample; `a` row by row.
struct Affine_map
{
  double a[9], t[3];
};

/// The affine map of the points around a handle; `turn`, row by row, maps their normals.
struct Handle_map
{
  Affine_map map;
  double turn[9];
};

using Vec3 = Eigen::Vector3d;
using Row_major_matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

inline Affine_map identity_map()
{
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
}

/// Returns the rotation nearest to `a`; the identity if `a` is not invertible.
inline Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& a)
{
  const Vec3 x = a.col(0).normalized(), z = a.col(0).cross(a.col(1)).normalized();
  Eigen::Matrix3d start;
  start << x, z.cross(x), z;
  if (!(a.determinant() > 0) || !start.allFinite())
    return Eigen::Matrix3d::Identity();
  constexpr int number_of_steps = 20; // a few suffice until convergence
  return improve_rotation(a, Quaternion(start), number_of_steps).toRotationMatrix();
}

/// Returns the nearest rotation as `nearest_rotation()`, up to rounding also for large stretches.
inline Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& a)
{
  Eigen::Matrix3d r = nearest_rotation(a);
  if (!(a.determinant() > 0))
    return r;
  constexpr int number_of_steps = 20; // Newton's method: one or two from a near start
  for (int i = 0; i < number_of_steps; ++i) {
    const Vec3 turn = newton_turn(a * r.transpose(), 0);
    r = rotation_exp(turn).toRotationMatrix() * r;
    if (turn.squaredNorm() < 1e-26)
      break;
  }
  return r;
}

/// Returns the normal of a surface after the linear map `a`, with unchanged length.
inline Vec3 turn_normal(const Eigen::Matrix3d& a, const Vec3& normal)
{
  Eigen::Matrix3d cofactor;
  cofactor.row(0) = a.row(1).cross(a.row(2));
  cofactor.row(1) = a.row(2).cross(a.row(0));
  cofactor.row(2) = a.row(0).cross(a.row(1));
  const Vec3 turned = cofactor * normal;
  const double length = turned.norm();
  return length > 0 ? Vec3(normal.norm() / length * turned) : normal;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_AFFINE_MAP_H
