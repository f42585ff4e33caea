// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of a surface with normals, local spacings and a search tree.

#ifndef PCS_REGISTRATION_SURFACE_POINTS_H
#define PCS_REGISTRATION_SURFACE_POINTS_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/neighborhood/Nearest_neighbors.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace pcs {
namespace registration {

using Vec3 = Eigen::Vector3d;

/// Number of neighbours from which a normal and a spacing are estimated. [count]
constexpr std::size_t neighbors_of_normal = 16;
/// Rank of the neighbour whose distance is the reach of a point. On a uniform surface, the reach is
/// 1.6 times the side of the square that belongs to a point. [count]
constexpr std::size_t neighbor_of_reach = 8;

/// Largest reach of a point of a surface. Steps of the density by a factor of four have a ratio
/// of 2. [median reaches of the neighbours]
constexpr double isolated_reach = 3;

/// Returns the direction of least spread of the points around `center`, or the null vector if they
/// do not determine a plane, as on a line. [-]
inline Vec3 normal_of_points(const std::vector<Vec3>& points,
                             const std::vector<neighborhood::Nearest_neighbors::Neighbor>& around)
{
  Vec3 mean = Vec3::Zero();
  for (const auto& a : around)
    mean += points[a.index];
  mean /= static_cast<double>(std::max<std::size_t>(1, around.size()));
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& a : around) {
    const Vec3 d = points[a.index] - mean;
    covariance += d * d.transpose();
  }
  const auto eigen = linear_algebra::symmetric_eigen<3>(covariance);
  constexpr double least_width = 1e-4; // of the squared spread across, relative to along
  if (!(eigen.values[1] > least_width * eigen.values[2]))
    return Vec3::Zero();
  return eigen.vectors.col(0);
}

/// A cloud that is searched: positions, normals (null where unknown) and reaches.
class Surface_points
{
public:
  using Neighbor = neighborhood::Nearest_neighbors::Neighbor;

  /// \param normals one for each point, or empty: they are estimated, without a side
  template <class ConcurrencyTag>
  void build(std::vector<Vec3> points, std::vector<Vec3> normals)
  {
    m_points = std::move(points);
    m_tree = std::make_unique<neighborhood::Nearest_neighbors>(m_points);
    const bool is_given = !normals.empty();
    m_normals = is_given ? std::move(normals) : std::vector<Vec3>(size(), Vec3::Zero());
    m_reach.assign(size(), 0);
    pcs::internal::for_each_block<ConcurrencyTag>(
        size(),
        256,
        [&](std::size_t begin, std::size_t end) {
          std::vector<Neighbor> around;
          for (std::size_t i = begin; i < end; ++i) {
            (*m_tree)(m_points[i], neighbors_of_normal, around);
            m_reach[i] =
                std::sqrt(around[std::min(neighbor_of_reach, around.size() - 1)].squared_distance);
            if (!is_given)
              m_normals[i] = normal_of_points(m_points, around);
          }
        });
  }

  /// Replaces positions and normals, and keeps the reaches.
  void move(std::vector<Vec3> points, std::vector<Vec3> normals)
  {
    m_tree.reset();
    m_points = std::move(points);
    m_normals = std::move(normals);
    m_tree = std::make_unique<neighborhood::Nearest_neighbors>(m_points);
  }

  /// Returns the points whose surroundings are not much denser than themselves: the reach of the
  /// others exceeds `isolated_reach` times the median reach of their neighbours.
  template <class ConcurrencyTag>
  std::vector<std::uint32_t> points_of_surface() const
  {
    std::vector<char> is_isolated(size(), 0);
    pcs::internal::for_each_block<ConcurrencyTag>(
        size(),
        256,
        [&](std::size_t begin, std::size_t end) {
          std::vector<Neighbor> around;
          std::vector<double> reach;
          for (std::size_t i = begin; i < end; ++i) {
            (*m_tree)(m_points[i], neighbor_of_reach + 1, around);
            reach.clear();
            for (const Neighbor& a : around)
              if (a.index != i)
                reach.push_back(m_reach[a.index]);
            is_isolated[i] = m_reach[i] > isolated_reach * pcs::internal::lower_median(reach);
          }
        });
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < size(); ++i)
      if (!is_isolated[i])
        result.push_back(static_cast<std::uint32_t>(i));
    return result;
  }

  std::size_t size() const { return m_points.size(); }
  const std::vector<Vec3>& points() const { return m_points; }
  const std::vector<Vec3>& normals() const { return m_normals; }
  double reach(std::size_t i) const { return m_reach[i]; }
  const neighborhood::Nearest_neighbors& tree() const { return *m_tree; }

  /// Median reach. [L]
  double median_reach() const
  {
    std::vector<double> values = m_reach;
    return pcs::internal::lower_median(values);
  }

private:
  std::vector<Vec3> m_points, m_normals;
  std::vector<double> m_reach;
  std::unique_ptr<neighborhood::Nearest_neighbors> m_tree;
};

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_SURFACE_POINTS_H
