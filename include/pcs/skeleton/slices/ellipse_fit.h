// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ellipse fits: general conic, direct ellipse, and circle.

#ifndef PCS_SKELETON_SLICES_ELLIPSE_FIT_H
#define PCS_SKELETON_SLICES_ELLIPSE_FIT_H

#include <pcs/core/Skeleton_options.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

struct Ellipse
{
  Vec2 center = Vec2::Zero();
  double major = 0, minor = 0;    ///< semi-axes; 0: no ellipse
  Vec2 direction = Vec2::UnitX(); ///< of the major axis
  double deviation =
      /// root mean square distance of the points, along the ray from the centre [L]
      0;
};

namespace internal {

/// Returns the ellipse a x^2 + b x y + c y^2 + d x + e y + f = 0, or none for other conics.
inline Ellipse ellipse_of_conic(double a, double b, double c, double d, double e, double f)
{
  Ellipse result;
  const double det = 4 * a * c - b * b;
  if (!(det > 0) || !std::isfinite(det))
    return result;
  const Vec2 center((b * e - 2 * c * d) / det, (b * d - 2 * a * e) / det);
  const double at_center = f + 0.5 * (d * center.x() + e * center.y());
  Eigen::Matrix2d m;
  m << a, b / 2, b / 2, c;
  const auto eigen = linear_algebra::symmetric_eigen<2>(m);
  const double s0 = -at_center / eigen.values(0), s1 = -at_center / eigen.values(1);
  if (!(s0 > 0) || !(s1 > 0) || !std::isfinite(s0) || !std::isfinite(s1))
    return result;
  const int large = s0 > s1 ? 0 : 1;
  result.center = center;
  result.major = std::sqrt(large == 0 ? s0 : s1);
  result.minor = std::sqrt(large == 0 ? s1 : s0);
  result.direction = eigen.vectors.col(large);
  return result;
}

inline Ellipse fit_conic(const std::vector<Vec2>& points)
{
  Eigen::Matrix<double, 5, 5> a = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> b = Eigen::Matrix<double, 5, 1>::Zero();
  for (const Vec2& p : points) {
    Eigen::Matrix<double, 5, 1> f;
    f << p.x() * p.x(), p.x() * p.y(), p.y() * p.y(), p.x(), p.y();
    a += f * f.transpose();
    b -= f;
  }
  Eigen::Matrix<double, 5, 1> x;
  return linear_algebra::solve_symmetric(a, b, x)
             ? ellipse_of_conic(x(0), x(1), x(2), x(3), x(4), 1)
             : Ellipse();
}

/// Fits the ellipse of least algebraic distance: minimizes `v^T m v` for quadratic terms `v` with
/// `4 a c - b^2 = 1`, where `m` results from elimination of the linear terms. The solution is that
/// of Halir and Flusser, who compute eigenvectors of a nonsymmetric matrix.
inline Ellipse fit_direct(const std::vector<Vec2>& points)
{
  Eigen::Matrix3d s1 = Eigen::Matrix3d::Zero(), s2 = s1, s3 = s1;
  for (const Vec2& p : points) {
    const Eigen::Vector3d q(p.x() * p.x(), p.x() * p.y(), p.y() * p.y()), l(p.x(), p.y(), 1);
    s1 += q * q.transpose();
    s2 += q * l.transpose();
    s3 += l * l.transpose();
  }
  Eigen::Matrix3d t;
  if (!linear_algebra::solve_symmetric(s3, Eigen::Matrix3d(s2.transpose()), t))
    return Ellipse();
  const Eigen::Matrix3d rest = s1 - s2 * t;
  auto left = linear_algebra::symmetric_eigen<3>(0.5 * (rest + rest.transpose()));
  const double largest = left.values(2);
  if (!(largest > 0) || !left.values.allFinite())
    return Ellipse();
  for (int k = 0; k < 3; ++k) // on an exact ellipse, one of the values is zero
    left.vectors.col(k) /= std::sqrt(std::max(left.values(k), 1e-15 * largest));
  Eigen::Matrix3d discriminant = Eigen::Matrix3d::Zero();
  discriminant(0, 2) = discriminant(2, 0) = 2;
  discriminant(1, 1) = -1;
  const auto right =
      linear_algebra::symmetric_eigen<3>(left.vectors.transpose() * discriminant * left.vectors);
  const Eigen::Vector3d v = left.vectors * right.vectors.col(2), l = -(t * v);
  return ellipse_of_conic(v(0), v(1), v(2), l(0), l(1), l(2));
}

} // namespace internal

/// Least number of sectors of 12 with points for a reliable ellipse [count].
constexpr int sectors_of_an_ellipse = 9;

/// Fits a section by the method `how`. Points are centred and scaled first, because the algebraic
/// fits are not invariant.
inline Ellipse fit_section(const std::vector<Vec2>& points, Section_fit how)
{
  Ellipse result;
  if (points.size() < 6)
    return result;
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points)
    mean += p;
  mean /= double(points.size());
  double scale = 0;
  for (const Vec2& p : points)
    scale += (p - mean).squaredNorm();
  scale = std::sqrt(scale / double(points.size()));
  if (!(scale > 0))
    return result;
  std::vector<Vec2> unit;
  unit.reserve(points.size());
  for (const Vec2& p : points)
    unit.push_back((p - mean) / scale);
  const Circle circle = fit_circle(unit);
  const bool is_seen_around =
      circle.radius > 0 && covered_sectors(unit, circle.center) >= sectors_of_an_ellipse;
  if (how == Section_fit::conic)
    result = internal::fit_conic(unit);
  else if (how == Section_fit::ellipse || (how == Section_fit::by_arc && is_seen_around))
    result = internal::fit_direct(unit);
  if (how == Section_fit::circle || (how == Section_fit::by_arc && !(result.major > 0))) {
    result.center = circle.center;
    result.major = result.minor = circle.radius;
  }
  if (!(result.major > 0) || !std::isfinite(result.major))
    return Ellipse();
  double sum = 0;
  for (const Vec2& p : unit) {
    const Vec2 d = p - result.center;
    const double u = d.dot(result.direction) / result.major;
    const double v = (d.y() * result.direction.x() - d.x() * result.direction.y()) / result.minor;
    const double q = std::hypot(u, v);
    const double off = q > 0 ? d.norm() * (1 - 1 / q) : result.minor;
    sum += off * off;
  }
  result.deviation = scale * std::sqrt(sum / double(points.size()));
  result.center = mean + scale * result.center;
  result.major *= scale;
  result.minor *= scale;
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_ELLIPSE_FIT_H
