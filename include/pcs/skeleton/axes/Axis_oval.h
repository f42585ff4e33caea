// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Oval cross-section of an axis with one-sided visibility.

#ifndef PCS_SKELETON_AXES_AXIS_OVAL_H
#define PCS_SKELETON_AXES_AXIS_OVAL_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/axes/Axis_fit.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the oval cross-section of an axis.
struct Oval_options
{
  double one_sided =
      0.4; ///< least length of the mean normal of the points: full rings need no correction [-]
  double thickness = 6;     ///< least radius, in standard deviations of the noise [-] ...
  double spacings = 2;      ///< ... and in spacings [-]
  double usual = 0.04;      ///< prior standard deviation of each coefficient [-]
  double largest = 0.2;     ///< upper bound on the norm of the coefficients [-]
  double roughness = 0.015; ///< roughness of the surface, in radii [-]
  double stretch = 2;       ///< least length of a stretch with one center and radius, in radii ...
  std::size_t count = 30;   ///< ... and the least number of its points [count]
  std::size_t fewest = 6;   ///< number of points below which the last stretch is ignored [count]
  int rounds = 3;           ///< most estimates of the oval, each followed by a fit [count]
  double settled = 0.002;   ///< change of the coefficients that ends the estimation [-]
};

/*!
  Oval `r (1 + x cos 2a + y sin 2a)` that all sections of an axis have in common. The angle a refers
  to frames that do not rotate about the axis.
*/
class Axis_oval
{
public:
  explicit Axis_oval(const Axis& axis)
  {
    const std::vector<Axis_segment> lines = segments_of(axis);
    Vec3 side = Vec3::Zero();
    for (const Axis_segment& line : lines) {
      const double length = line.along.norm();
      const Vec3 along = length > 0 ? Vec3(line.along / length) : Vec3(Vec3::UnitZ());
      side -= side.dot(along) * along;
      side = side.norm() > 0.1 ? Vec3(side.normalized()) : Vec3(along.unitOrthogonal());
      m_first.push_back(side);
      m_second.push_back(along.cross(side));
    }
  }

  const Eigen::Vector2d& coefficients() const { return m_coefficients; }

  /// Returns the standard error of the coefficients after `improve()`: the root of the trace of
  /// their covariance. [-]
  double error() const { return m_error; }

  /// Returns the unit vector along the longest diameter of the sections of a segment.
  Vec3 longest_direction(std::size_t segment) const
  {
    const double angle = 0.5 * std::atan2(m_coefficients.y(), m_coefficients.x());
    return std::cos(angle) * m_first[segment] + std::sin(angle) * m_second[segment];
  }

  /*!
    Updates the coefficients from the residuals of a fit by weighted least squares. The center and
    radius of every stretch are further unknowns, which are eliminated. On a single arc, a shift of
    the center causes nearly the same residuals as ovality, so that many sections are needed.
    `noise`: standard deviation of the points [L]. O(points).
  */
  void improve(const Axis_fit& fit, double noise, const Oval_options& rules);

  /// Moves the points by the deviation of the oval from a circle, at their projections in `fit`.
  /// O(points).
  std::vector<Vec3> rounded(std::vector<Vec3> points, const Axis_fit& fit) const
  {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Axis_place& p = fit.places()[i];
      if (!(p.distance > 0))
        continue;
      const Vec3 normal = (fit.points()[i] - point_at(fit.axis(), p)) / p.distance;
      const double height = m_coefficients.dot(harmonic(p.segment, normal));
      points[i] -= height * radius_at(fit.axis(), p) * normal;
    }
    return points;
  }

private:
  /// Returns cos 2a and sin 2a of a unit vector across a segment.
  Eigen::Vector2d harmonic(Index segment, const Vec3& normal) const
  {
    const double c = normal.dot(m_first[segment]), s = normal.dot(m_second[segment]);
    const double n = c * c + s * s;
    return n > 0 ? Eigen::Vector2d((c * c - s * s) / n, 2 * c * s / n) : Eigen::Vector2d(0, 0);
  }

  std::vector<Vec3> m_first, m_second; ///< frames of the segments
  Eigen::Vector2d m_coefficients = Eigen::Vector2d::Zero();
  double m_error = 0;
};

inline void Axis_oval::improve(const Axis_fit& fit, double noise, const Oval_options& rules)
{
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  const Axis& axis = fit.axis();
  const std::size_t n = axis.size() - 1;
  // unknowns: center across the axis (2), radius (1), oval (2)
  std::vector<Matrix5> products(n, Matrix5::Zero());
  std::vector<Vector5> slope(n, Vector5::Zero());
  std::vector<std::size_t> count(n, 0);
  for (std::size_t i = 0; i < fit.places().size(); i += fit.stride()) {
    const Axis_place& p = fit.places()[i];
    if (p.share < 0 || p.share > 1 || !(p.distance > 0))
      continue;
    const double r = radius_at(axis, p), e = p.distance - r;
    const double deviation = std::max(noise, rules.roughness * r);
    const double x = e / (tukey_constant * deviation);
    if (x * x >= 1)
      continue;
    const double w = double(fit.stride()) * (1 - x * x) * (1 - x * x) / (deviation * deviation);
    const Vec3 normal = (fit.points()[i] - point_at(axis, p)) / p.distance;
    const Eigen::Vector2d h = harmonic(p.segment, normal);
    Vector5 f;
    f << normal.dot(m_first[p.segment]), normal.dot(m_second[p.segment]), 1, r * h.x(), r * h.y();
    products[p.segment] += w * f * f.transpose();
    slope[p.segment] += w * e * f;
    ++count[p.segment];
  }
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity() / (rules.usual * rules.usual);
  Eigen::Vector2d right = -m_coefficients / (rules.usual * rules.usual);
  for (std::size_t b = 0, e = 0; b < n; b = e) {
    Matrix5 a = Matrix5::Zero();
    Vector5 h = Vector5::Zero();
    double length = 0;
    std::size_t points = 0;
    while (e < n && (length < rules.stretch * axis[b].radius || points < rules.count)) {
      a += products[e];
      h += slope[e];
      points += count[e];
      length += (axis[e + 1].point - axis[e].point).norm();
      ++e;
    }
    if (points < rules.fewest)
      continue;
    const Eigen::Matrix3d own = a.topLeftCorner<3, 3>();
    const Eigen::Matrix<double, 3, 2> mixed = a.topRightCorner<3, 2>();
    Eigen::Matrix<double, 3, 2> m;
    Vec3 v;
    if (!linear_algebra::solve_symmetric(own, mixed, m) ||
        !linear_algebra::solve_symmetric(own, Vec3(h.head<3>()), v))
      continue;
    information += a.bottomRightCorner<2, 2>() - mixed.transpose() * m;
    right += h.tail<2>() - mixed.transpose() * v;
  }
  Eigen::Vector2d change;
  if (linear_algebra::solve_symmetric(information, right, change))
    m_coefficients += change;
  // trace of the inverse of a symmetric 2 x 2 matrix
  m_error = std::sqrt(information.trace() / information.determinant());
  const double size = m_coefficients.norm();
  if (size > rules.largest)
    m_coefficients *= rules.largest / size;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_AXIS_OVAL_H
