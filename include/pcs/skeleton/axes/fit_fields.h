// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Regression of the density and visibility fields on samples.

#ifndef PCS_SKELETON_AXES_FIT_FIELDS_H
#define PCS_SKELETON_AXES_FIT_FIELDS_H

#include <pcs/internal/median.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Density_field.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Visibility_field.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

inline Sample_frame::Sample_frame(const std::vector<Density_sample>& samples)
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
  m_reach = std::sqrt(3.0) * eigen.values.cwiseMax(0).cwiseSqrt(); // if uniform
}

/// Returns at most 3000 samples at a constant stride.
inline std::vector<Density_sample> subsample(const std::vector<Density_sample>& all)
{
  constexpr std::size_t most = 3000;
  std::vector<Density_sample> samples;
  const std::size_t stride = (all.size() + most - 1) / most;
  for (std::size_t i = 0; i < all.size(); i += stride)
    samples.push_back(all[i]);
  return samples;
}

inline void Density_field::learn(const std::vector<Density_sample>& all)
{
  m_is_known = all.size() >= fewest_samples;
  if (!m_is_known)
    return;
  const std::vector<Density_sample> samples = subsample(all);
  m_frame = Sample_frame(samples);
  std::vector<double> values, errors(samples.size());
  for (const Density_sample& s : samples)
    values.push_back(std::log(s.density));
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t tail = sorted.size() / 20; // outliers
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
    const double deviation = std::max(least_deviation, 1.4826 * pcs::internal::lower_median(copy));
    Eigen::Matrix<double, size, size> matrix = Eigen::Matrix<double, size, size>::Identity();
    Row right = Row::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double x = errors[i] / (2 * deviation);
      const double w = 1 / ((1 + x * x) * deviation * deviation * shared);
      matrix += w * rows[i] * rows[i].transpose();
      right += w * (values[i] - m_middle) * rows[i];
    }
    linear_algebra::solve_symmetric(matrix, right, m_weights);
  }
}

inline void Visibility_field::learn(const std::vector<Density_sample>& all)
{
  m_is_known = all.size() >= Density_field::fewest_samples;
  if (!m_is_known)
    return;
  const std::vector<Density_sample> samples = subsample(all);
  m_frame = Sample_frame(samples);
  m_weights.setZero();
  m_deviation = 0;
  std::vector<double> errors(samples.size());
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      errors[i] = (samples[i].facing - (*this)(samples[i].place, samples[i].along)).norm();
    std::vector<double> copy = errors;
    m_deviation = std::max(least_deviation, pcs::internal::lower_median(copy));
    Matrix matrix = Matrix::Identity();
    Weights right = Weights::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double x = errors[i] / (2 * m_deviation);
      const double w = 1 / ((1 + x * x) * m_deviation * m_deviation * Density_field::shared);
      const Row r = row(samples[i].place);
      const Vec3& t = samples[i].along;
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - t * t.transpose();
      for (Eigen::Index a = 0; a < size; ++a) {
        for (Eigen::Index b = 0; b < size; ++b)
          matrix.block<3, 3>(3 * a, 3 * b) += w * r[a] * r[b] * across;
        right.segment<3>(3 * a) += w * r[a] * (across * samples[i].facing);
      }
    }
    linear_algebra::solve_symmetric(matrix, right, m_weights);
  }
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXES_FIT_FIELDS_H
