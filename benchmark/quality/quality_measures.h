// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Measures of a deformed cloud over arbitrary edges, and of the collapse of its cross-sections.

#ifndef PCS_BENCHMARK_QUALITY_QUALITY_MEASURES_H
#define PCS_BENCHMARK_QUALITY_QUALITY_MEASURES_H

#include <pcs/neighborhood/Proximity_graph.h>
#include <support/deformation_cases.h>

#include <CGAL/tags.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs_bench {

using pcs_test::Deformation_case;
using pcs_test::Deformation_measures;
using pcs_test::Vec3;
using Edges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Links to the six nearest points, for clouds without a mesh. Points must be distinct.
inline Edges neighbor_edges(const std::vector<Vec3>& points)
{
  const auto graph = pcs::neighborhood::nearest_neighbor_graph<CGAL::Sequential_tag>(points, 6);
  Edges edges;
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (auto j = graph.begin(i); j != graph.end(i); ++j)
      if (i < *j)
        edges.emplace_back(static_cast<std::uint32_t>(i), *j);
  return edges;
}

/// The rotation nearest to `covariance`.
inline Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& covariance)
{
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0)
    u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

/// Same as `pcs_test::measure()`, over the given edges instead of those of a mesh.
inline Deformation_measures
measure(const Deformation_case& c, const Edges& edges, const std::vector<Vec3>& deformed)
{
  Deformation_measures m;
  const std::size_t n = c.points.size();
  std::vector<char> is_handle(n, 0);
  for (const auto& handle : c.handles)
    for (const auto i : handle)
      is_handle[i] = 1;
  std::vector<Eigen::Matrix3d> fit(n, Eigen::Matrix3d::Zero());
  std::size_t count = 0;
  for (const auto& [i, j] : edges) {
    const Vec3 before = c.points[j] - c.points[i], after = deformed[j] - deformed[i];
    fit[i] += after * before.transpose();
    fit[j] += after * before.transpose();
    if (is_handle[i] && is_handle[j])
      continue;
    const double distortion = std::abs(after.norm() / before.norm() - 1);
    m.rms_edge += distortion * distortion;
    m.largest_edge = std::max(m.largest_edge, distortion);
    ++count;
  }
  m.rms_edge = std::sqrt(m.rms_edge / double(count));
  for (auto& f : fit)
    f = nearest_rotation(f);
  count = 0;
  for (const auto& [i, j] : edges) {
    if (is_handle[i] && is_handle[j])
      continue;
    const double a = pcs_test::angle_degrees(fit[i].transpose() * fit[j]);
    m.rotation_smoothness += a * a;
    ++count;
  }
  m.rotation_smoothness = std::sqrt(m.rotation_smoothness / double(count));
  m.frame_error = m.position_error = m.largest_position_error = no_value;
  m.volume_ratio = no_value;
  if (c.exact) {
    double frames = 0, positions = 0, largest = 0;
    count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_handle[i])
        continue;
      const double a = pcs_test::angle_degrees(c.exact_rotation(c.points[i]).transpose() * fit[i]);
      const double d = (deformed[i] - c.exact(c.points[i])).norm() / c.length;
      frames += a * a;
      positions += d * d;
      largest = std::max(largest, d);
      ++count;
    }
    m.frame_error = std::sqrt(frames / double(count));
    m.position_error = std::sqrt(positions / double(count));
    m.largest_position_error = largest;
  }
  if (c.is_closed)
    m.volume_ratio =
        pcs_test::mesh_volume(deformed, c.triangles) / pcs_test::mesh_volume(c.points, c.triangles);
  return m;
}

/*!
  Smallest ratio of the mean radius of a cross-section to its mean radius at rest, for bars and
  tubes along z. A ratio of 1 is exact and 0 is a collapse. Each of 24 slices between the clamps is
  rotated back by the best rotation of the slice, so that only its width is measured. Cases need
  handles at both ends of z, since free ends are not slices.
*/
inline double smallest_section(const Deformation_case& c, const std::vector<Vec3>& deformed)
{
  if (!c.exact_rotation)
    return no_value;
  double low = 0, high = c.length;
  for (const auto i : c.handles[0])
    low = std::max(low, c.points[i].z());
  for (const auto i : c.handles[1])
    high = std::min(high, c.points[i].z());
  constexpr std::size_t number_of_slices = 24;
  std::vector<std::vector<std::size_t>> slices(number_of_slices);
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const double t = (c.points[i].z() - low) / (high - low);
    if (t > 0 && t < 1)
      slices[std::size_t(t * number_of_slices)].push_back(i);
  }
  double smallest = no_value;
  for (const auto& slice : slices) {
    if (slice.size() < 8)
      continue;
    Vec3 rest_mean = Vec3::Zero(), mean = Vec3::Zero();
    for (const std::size_t i : slice) {
      rest_mean += c.points[i] / double(slice.size());
      mean += deformed[i] / double(slice.size());
    }
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const std::size_t i : slice)
      covariance += (deformed[i] - mean) * (c.points[i] - rest_mean).transpose();
    const Eigen::Matrix3d turn = nearest_rotation(covariance);
    double before = 0, after = 0;
    for (const std::size_t i : slice) {
      before += (c.points[i] - rest_mean).head<2>().squaredNorm();
      after += (turn.transpose() * (deformed[i] - mean)).head<2>().squaredNorm();
    }
    const double ratio = std::sqrt(after / before);
    if (!(smallest <= ratio))
      smallest = ratio;
  }
  return smallest;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_QUALITY_MEASURES_H
