// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Point density on branches as a function of position and surface direction.

#ifndef PCS_SKELETON_MODEL_DENSITY_FIELD_H
#define PCS_SKELETON_MODEL_DENSITY_FIELD_H

#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Sample of point density and visibility at a reliable section.
struct Density_sample
{
  double density; ///< points per area [1/L^2]
  double radius;  ///< of the section [L]
  Vec3 place;
  Vec3 along;                 ///< unit vector along the axis
  Vec3 facing = Vec3::Zero(); ///< mean of the outward normals of its points
};

/// Normalized coordinates relative to the mean and spread of samples. Beyond the samples, a field
/// is evaluated at the nearest position among them: a polynomial fitted on a trunk does not
/// extrapolate to the crown.
class Sample_frame
{
public:
  Sample_frame() = default;
  /// Requires at least one sample. Defined in fit_fields.h.
  explicit Sample_frame(const std::vector<Density_sample>& samples);

  Vec3 operator()(const Vec3& place) const { return m_scale * (place - m_center); }

  /// Returns coordinates clamped to the box around nearly all samples.
  Vec3 within(const Vec3& place) const
  {
    const Vec3 q = m_sides.transpose() * (*this)(place);
    return m_sides * q.cwiseMin(m_reach).cwiseMax(-m_reach);
  }

private:
  Vec3 m_center = Vec3::Zero();
  double m_scale = 1;
  Eigen::Matrix3d m_sides = Eigen::Matrix3d::Identity(); ///< axes of the box, by columns
  Vec3 m_reach = Vec3::Zero();                           ///< half extents of the box, in the frame
};

/*!
  Point density on branches. It decreases with the distance from a station, and on branches directed
  towards the station.

  The density `D` [1/L^2] at the position `x` [L] along the unit vector `t` [-] is

      ln D(x, t) = m + w . phi(q, t),   q = (x - center) scale                               [-]

  with the 16 monomials `phi`: 1 and the entries of `q`, `q q^T` and `t t^T`. Mixed products have
  the factor sqrt(2), so that the ridge is invariant to rotations. The mean of `|q|^2` is 3. Robust
  ridge regression over `w` [-] minimises

      |w|^2 + sum_i (ln D_i - m - w . phi_i)^2 / (5 s^2 (1 + (e_i / (2 s))^2))               [-]

  over the samples, at most 3000, with the median `m` of `ln D_i`. In each of four rounds, the
  absolute residuals `e_i` of the previous round yield Cauchy weights, and
  `s = max(0.05, 1.4826 median e_i)`; the factor 5 is `shared`. Positions are clamped to the box of
  the samples, and predictions to the 5 % and 95 % quantiles of their densities. O(samples).
*/
class Density_field
{
public:
  static constexpr std::size_t fewest_samples = 60;
  static constexpr double shared = 5; ///< number of adjacent sections with points in common [count]

  /// Returns whether there were enough samples.
  bool is_known() const { return m_is_known; }

  /// Fits the field to samples of positive density. O(samples). Defined in fit_fields.h, as it
  /// takes long to compile.
  void learn(const std::vector<Density_sample>& all);

  /// Returns the points per area of a branch at `place` along the unit vector `along` [1/L^2].
  double operator()(const Vec3& place, const Vec3& along) const
  {
    const double value = m_middle + m_weights.dot(row(m_frame.within(place), along));
    return std::exp(std::min(m_highest, std::max(m_lowest, value)));
  }

private:
  static constexpr int size = 16;
  static constexpr double least_deviation = 0.05;
  using Row = Eigen::Matrix<double, size, 1>;

  /// `q`: position in the frame [-].
  static Row row(const Vec3& q, const Vec3& t)
  {
    const double root = std::sqrt(2.0); // makes the ridge invariant to rotations
    Row r;
    r << 1, q.x(), q.y(), q.z(), q.x() * q.x(), q.y() * q.y(), q.z() * q.z(), root * q.x() * q.y(),
        root * q.x() * q.z(), root * q.y() * q.z(), t.x() * t.x(), t.y() * t.y(), t.z() * t.z(),
        root * t.x() * t.y(), root * t.x() * t.z(), root * t.y() * t.z();
    return r;
  }

  bool m_is_known = false;
  Sample_frame m_frame;
  double m_middle = 0, m_lowest = 0, m_highest = 0; // of logarithms
  Row m_weights = Row::Zero();
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_DENSITY_FIELD_H
