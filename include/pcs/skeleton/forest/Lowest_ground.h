// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Height above the ground of a stand: above the higher of its surface, if enough of it is seen, and
// of a bound from the lowest points q of a horizontal grid and a largest slope s,
//
//   bound(p) = min over q of  z_q + s |p - q|, with the horizontal distance.

#ifndef PCS_SKELETON_FOREST_LOWEST_GROUND_H
#define PCS_SKELETON_FOREST_LOWEST_GROUND_H

#include <pcs/skeleton/forest/Sparse_ground.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {
namespace internal {

/// The ground below the stems of a stand. z points upwards.
class Lowest_ground
{
public:
  /// `surface`: of the ground, if enough of it is seen; a reference is kept. `cell`: side of the
  /// squares [L]; `slope`: steepest ground without a surface [-].
  Lowest_ground(const Scan& scan,
                const std::optional<Sparse_ground>& surface,
                double cell,
                double slope,
                const std::vector<std::uint8_t>& is_solid)
    : m_surface(surface), m_slope(slope)
  {
    std::map<std::pair<double, double>, Vec3> lowest;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (!is_solid[i])
        continue;
      const Vec3& p = scan.points[i];
      const auto [at, is_new] =
          lowest.emplace(std::make_pair(std::floor(p.x() / cell), std::floor(p.y() / cell)), p);
      if (!is_new && p.z() < at->second.z())
        at->second = p;
    }
    for (const auto& entry : lowest)
      m_lowest.push_back(entry.second);
  }

  /// Returns the height of a point above the ground. O(cells).
  double height(const Vec3& p) const
  {
    double ground = std::numeric_limits<double>::infinity();
    for (const Vec3& q : m_lowest)
      ground = std::min(ground, q.z() + m_slope * std::hypot(p.x() - q.x(), p.y() - q.y()));
    return m_surface ? std::min(p.z() - ground, m_surface->height(p)) : p.z() - ground;
  }

private:
  const std::optional<Sparse_ground>& m_surface;
  double m_slope;
  std::vector<Vec3> m_lowest;
};

} // namespace internal
} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_LOWEST_GROUND_H
