// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How many points per area a branch has, by where it is and where it points to.

#ifndef PCS_SKELETON_DENSITY_FIELD_H
#define PCS_SKELETON_DENSITY_FIELD_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/Scan.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// What one good section says about the scan.
struct Density_sample
{
  double density; ///< points per area [1/L^2]
  double radius;  ///< of the section [L]
  Vec3 place;
  Vec3 along;                 ///< unit vector along the axis
  Vec3 facing = Vec3::Zero(); ///< mean of the outward normals of its points
};

/// Places relative to the middle of samples, in their spread. Beyond the samples a field goes on as at the nearest place among
/// them: a polynomial that was learned on a trunk says nothing of the crown.
class Sample_frame
{
public:
  Sample_frame() = default;
  /// At least one sample.
  explicit Sample_frame(const std::vector<Density_sample>& samples)
  {
    for (const Density_sample& s : samples)
      m_center += s.place;
    m_center /= double(samples.size());
    double spread = 0;
    for (const Density_sample& s : samples)
      spread += (s.place - m_center).squaredNorm();
    m_scale = spread > 0 ? std::sqrt(3 * double(samples.size()) / spread) : 1;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Density_sample& s : samples) {
      const Vec3 q = (*this)(s.place);
      covariance += q * q.transpose() / double(samples.size());
    }
    const auto eigen = linear_algebra::symmetric_eigen<3>(covariance);
    m_sides = eigen.vectors;
    m_reach = std::sqrt(3.0) * eigen.values.cwiseMax(0).cwiseSqrt(); // of even samples
  }

  Vec3 operator()(const Vec3& place) const { return m_scale * (place - m_center); }

  /// That of the nearest place in the box about nearly all samples.
  Vec3 within(const Vec3& place) const
  {
    const Vec3 q = m_sides.transpose() * (*this)(place);
    return m_sides * q.cwiseMin(m_reach).cwiseMax(-m_reach);
  }

private:
  Vec3 m_center = Vec3::Zero();
  double m_scale = 1;
  Eigen::Matrix3d m_sides = Eigen::Matrix3d::Identity(); ///< of the box, by columns
  Vec3 m_reach = Vec3::Zero();                           ///< half its lengths, in the frame
};

/// Some thousand of all samples, evenly.
inline std::vector<Density_sample> some_of(const std::vector<Density_sample>& all)
{
  constexpr std::size_t most = 3000;
  std::vector<Density_sample> samples;
  const std::size_t stride = (all.size() + most - 1) / most;
  for (std::size_t i = 0; i < all.size(); i += stride)
    samples.push_back(all[i]);
  return samples;
}

/*!
  Points thin out with the distance from a station, and where a branch points to it: the logarithm of the density is a
  polynomial of second degree of the place and of the direction. Robust least squares with a ridge; neither a place nor a
  prediction leaves the range of the samples.
*/
class Density_field
{
public:
  static constexpr std::size_t fewest_samples = 60;
  static constexpr double shared = 5; ///< sections next to each other share points [count]

  /// Whether there were enough samples.
  bool is_known() const { return m_is_known; }

  /// Fits the field to samples of positive density. O(samples).
  void learn(const std::vector<Density_sample>& all)
  {
    m_is_known = all.size() >= fewest_samples;
    if (!m_is_known)
      return;
    const std::vector<Density_sample> samples = some_of(all);
    m_frame = Sample_frame(samples);
    std::vector<double> values, errors(samples.size());
    for (const Density_sample& s : samples)
      values.push_back(std::log(s.density));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t tail = sorted.size() / 20; // odd ones
    m_middle = sorted[sorted.size() / 2];
    m_lowest = sorted[tail];
    m_highest = sorted[sorted.size() - 1 - tail];
    std::vector<Row> rows;
    for (const Density_sample& s : samples)
      rows.push_back(row(m_frame(s.place), s.along));
    m_weights.setZero();
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t i = 0; i < rows.size(); ++i)
        errors[i] = std::abs(values[i] - m_middle - m_weights.dot(rows[i]));
      std::vector<double> copy = errors;
      const double deviation = std::max(least_deviation, 1.4826 * median(copy));
      Eigen::Matrix<double, size, size> matrix = Eigen::Matrix<double, size, size>::Identity();
      Row right = Row::Zero();
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double x = errors[i] / (2 * deviation);
        const double w = 1 / ((1 + x * x) * deviation * deviation * shared);
        matrix.selfadjointView<Eigen::Lower>().rankUpdate(rows[i], w);
        right += w * (values[i] - m_middle) * rows[i];
      }
      m_weights = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    }
  }

  /// Points per area of a branch at `place` that runs along the unit vector `along` [1/L^2].
  double operator()(const Vec3& place, const Vec3& along) const
  {
    const double value = m_middle + m_weights.dot(row(m_frame.within(place), along));
    return std::exp(std::min(m_highest, std::max(m_lowest, value)));
  }

private:
  static constexpr int size = 16;
  static constexpr double least_deviation = 0.05;
  using Row = Eigen::Matrix<double, size, 1>;

  /// `q` is a place in the frame.
  static Row row(const Vec3& q, const Vec3& t)
  {
    const double root = std::sqrt(2.0); // the ridge is the same for a turned scan
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

#endif // PCS_SKELETON_DENSITY_FIELD_H
