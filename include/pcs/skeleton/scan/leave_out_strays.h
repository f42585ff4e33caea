// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stray points: isolated points that continue no surface, such as ghosts below the ground.
//
// A point p with local spacing d is isolated if d > isolated * s, with s the spacing of the scan. A
// plane is fitted to its nearest neighbours, and again to the two thirds of them that are nearest
// to this plane. Their covariance has the eigenvalues l0 <= l1 <= l2. With the distance h of p from
// the second plane, the point continues a surface if
//
//   sqrt(l0) + h <= sheet * sqrt(l1 + l2),
//
// as points of thin ground do. Otherwise, it is a stray point.

#ifndef PCS_SKELETON_SCAN_LEAVE_OUT_STRAYS_H
#define PCS_SKELETON_SCAN_LEAVE_OUT_STRAYS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Moments.h>
#include <pcs/skeleton/model/Scan.h>

#include <CGAL/tags.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for stray points.
struct Stray_options
{
  double isolated = 3; ///< least local spacing, in spacings of the scan [-]
  double sheet = 0.12; ///< largest distance from a surface, in extents of the neighbours in it [-]
};

namespace internal {

/// Returns whether a point lies near the plane of most of its neighbours.
inline bool continues_surface(const Scan& scan, Index i, const Stray_options& rules)
{
  std::vector<Vec3> around; // relative to the point
  for (const Index j : scan.neighbors[i])
    if (j != none)
      around.push_back(scan.points[j] - scan.points[i]);
  if (around.size() < spacing_neighbor)
    return false;
  for (const bool is_last : {false, true}) {
    Moments moments;
    for (const Vec3& d : around)
      moments.add(d);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance());
    const Vec3 normal = solver.eigenvectors().col(0), l = solver.eigenvalues().cwiseMax(0);
    const double level = normal.dot(moments.mean());
    if (is_last)
      return std::sqrt(l(0)) + std::abs(level) <= rules.sheet * std::sqrt(l(1) + l(2));
    const auto is_nearer = [&](const Vec3& a, const Vec3& b) {
      return std::abs(normal.dot(a) - level) < std::abs(normal.dot(b) - level);
    };
    std::stable_sort(around.begin(), around.end(), is_nearer);
    around.resize((2 * around.size() + 2) / 3);
  }
  return false;
}

} // namespace internal

/// Returns the points with `is_used` that are not stray points. O(n).
template <class ConcurrencyTag = CGAL::Sequential_tag>
std::vector<std::uint8_t> leave_out_strays(const Scan& scan,
                                           std::vector<std::uint8_t> is_used,
                                           const Stray_options& rules = {})
{
  pcs::internal::for_each_index<ConcurrencyTag>(scan.size(), [&](std::size_t i) {
    if (is_used[i] && scan.local_spacing[i] > rules.isolated * scan.spacing &&
        !internal::continues_surface(scan, static_cast<Index>(i), rules))
      is_used[i] = 0;
  });
  return is_used;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_LEAVE_OUT_STRAYS_H
