// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Flat parts of a surface, and the links of a neighbour graph that leave them.

#ifndef PCS_NEIGHBORHOOD_FLAT_PARTS_H
#define PCS_NEIGHBORHOOD_FLAT_PARTS_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/Proximity_graph.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <cstddef>
#include <vector>

namespace pcs {
namespace neighborhood {

/// Points are a surface, not a line, if the middle eigenvalue of their covariance exceeds this
/// fraction of the largest one. [-]
constexpr double smallest_width = 0.02;

namespace internal {

inline Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen_system(const Eigen::Matrix3d& m)
{
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(m);
  return eigen;
}

/// A plane through points on a flat part of a surface.
class Flat_part
{
public:
  Flat_part() = default; ///< not flat

  /// The plane of the points `point(0)` to `point(n - 1)`, not flat if their standard deviation
  /// across it is too large for links of the length `link` [L].
  template <class PointAt>
  Flat_part(std::size_t n, const PointAt& point, double link)
  {
    Vec3 sum = Vec3::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (std::size_t k = 1; k < n; ++k) {
      const Vec3 d = point(k) - point(0);
      sum += d;
      second += d * d.transpose();
    }
    const auto count = double(n);
    const auto eigen =
        eigen_system(Eigen::Matrix3d((second - sum * sum.transpose() / count) / count));
    const Vec3 values = eigen.eigenvalues();
    const double height = largest_height * link;
    m_is_flat = values[0] < height * height && values[1] > smallest_width * values[2] &&
                eigen.eigenvectors().allFinite();
    if (m_is_flat)
      m_normal = eigen.eigenvectors().col(0).cast<float>();
  }

  /// Returns whether an edge may leave the surface.
  bool may_leave(const Vec3& edge) const
  {
    const double height = m_normal.cast<double>().dot(edge);
    return !m_is_flat || height * height > largest_sine * largest_sine * edge.squaredNorm();
  }

private:
  static constexpr double largest_height = 0.4; ///< standard deviation from the plane / link [-]
  //! less than `smallest_short_cut_sine`, since the normal of a point differs from the plane [-]
  static constexpr double largest_sine = 0.35;

  Eigen::Vector3f m_normal = Eigen::Vector3f::Zero();
  bool m_is_flat = false;
};

/// Returns the flat part of each block of `size` consecutive points. In spatial order, most blocks
/// of a surface are flat.
template <class ConcurrencyTag>
std::vector<Flat_part>
flat_blocks(const std::vector<Vec3>& points, const Proximity_graph& graph, std::size_t size)
{
  std::vector<Flat_part> blocks(points.size() / size + 1);
  pcs::internal::for_each_index<ConcurrencyTag>(points.size() / size, [&](std::size_t b) {
    double length = 0;
    for (std::size_t i = b * size; i < (b + 1) * size; ++i)
      if (graph.degree(i) > 0)
        length += (points[*graph.begin(i)] - points[i]).norm();
    const auto point = [&](std::size_t k) { return points[b * size + k]; };
    blocks[b] = Flat_part(size, point, length / double(size));
  });
  return blocks;
}

/// Marks the links that may leave the surface at both ends, by `may_leave(i, edge)`, among those
/// that are marked. `is_end` becomes 1 for their ends.
template <class ConcurrencyTag, class MayLeave>
void keep_leaving(const std::vector<Vec3>& points,
                  const Proximity_graph& graph,
                  const MayLeave& may_leave,
                  std::vector<char>& is_marked,
                  std::vector<char>& is_end)
{
  pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
    if (!is_end[i])
      return;
    is_end[i] = 0;
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.neighbor[e];
      const Vec3 edge = points[j] - points[i];
      is_marked[e] = is_marked[e] && may_leave(i, edge) && may_leave(j, edge);
      is_end[i] |= is_marked[e];
    }
  });
}

/// Marks the links that may be short cuts, and their ends: links that leave the flat blocks of both
/// ends. This spares most points normals of their own.
template <class ConcurrencyTag>
void mark_suspected(const std::vector<Vec3>& points,
                    const Proximity_graph& graph,
                    std::vector<char>& is_suspected,
                    std::vector<char>& is_end)
{
  constexpr std::size_t size = 64; // of a block [count]
  is_suspected.assign(graph.neighbor.size(), 1);
  is_end.assign(points.size(), 1);
  const std::vector<Flat_part> blocks = flat_blocks<ConcurrencyTag>(points, graph, size);
  const auto leaves_block = [&](std::size_t i, const Vec3& edge) {
    return blocks[i / size].may_leave(edge);
  };
  keep_leaving<ConcurrencyTag>(points, graph, leaves_block, is_suspected, is_end);
}

} // namespace internal

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_FLAT_PARTS_H
