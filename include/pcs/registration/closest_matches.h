// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Closest points with compatible normals, without matches across the borders of a cloud.

#ifndef PCS_REGISTRATION_CLOSEST_MATCHES_H
#define PCS_REGISTRATION_CLOSEST_MATCHES_H

#include <pcs/internal/parallel.h>
#include <pcs/registration/Surface_points.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace registration {

/// The closest point of a query. `weight` is 0 if there is none.
struct Closest_match
{
  std::uint32_t index = 0;
  double weight = 0;           ///< of the angle between the normals [-]
  double plane_distance = 0;   ///< signed distance from the tangent plane [L]
  double squared_distance = 0; ///< [L^2]
};

struct Match_limits
{
  double distance = 0; ///< largest distance [L]
  double cosine = 0.5; ///< least cosine between the normals [-]
  double overhang = 1; ///< largest distance along the tangent plane [reaches]
  bool is_oriented = false;
};

/*!
  Returns the closest point of `cloud` to `query` whose normal deviates little from `normal`. A
  match is refused if its tangential distance exceeds the reach of the points there: the query then
  lies beside a border of the cloud, because inside a surface another point would be closer. The
  null vector as a normal is compatible with every normal.
*/
inline Closest_match find_closest(const Surface_points& cloud,
                                  const Vec3& query,
                                  const Vec3& normal,
                                  const Match_limits& limits)
{
  Closest_match result;
  const auto cosine_of = [&](std::uint32_t i) {
    const double c = cloud.normals()[i].dot(normal);
    return limits.is_oriented ? c : std::abs(c);
  };
  const bool has_normal = normal.squaredNorm() > 0;
  const auto is_compatible = [&](std::uint32_t i) {
    return !has_normal || !(cloud.normals()[i].squaredNorm() > 0) || cosine_of(i) >= limits.cosine;
  };
  const auto nearest = cloud.tree().nearest_if(query, limits.distance, is_compatible);
  if (!std::isfinite(nearest.squared_distance))
    return result;
  const Vec3& n = cloud.normals()[nearest.index];
  const Vec3 offset = query - cloud.points()[nearest.index];
  result.index = nearest.index;
  result.squared_distance = nearest.squared_distance;
  if (!(n.squaredNorm() > 0)) { // a line: no plane
    result.plane_distance = std::sqrt(nearest.squared_distance);
    result.weight = 1;
    return result;
  }
  result.plane_distance = n.dot(offset);
  const double tangential = (offset - result.plane_distance * n).norm();
  if (tangential > limits.overhang * cloud.reach(nearest.index))
    return result;
  result.weight = has_normal ? cosine_of(nearest.index) : 1;
  return result;
}

/// Finds the closest matches of all queries.
template <class ConcurrencyTag>
void find_closest_matches(const Surface_points& cloud,
                          const std::vector<Vec3>& queries,
                          const std::vector<Vec3>& normals,
                          const Match_limits& limits,
                          std::vector<Closest_match>& result)
{
  result.resize(queries.size());
  pcs::internal::for_each_index<ConcurrencyTag>(
      queries.size(),
      [&](std::size_t i) { result[i] = find_closest(cloud, queries[i], normals[i], limits); },
      256);
}

} // namespace registration
} // namespace pcs

#endif // PCS_REGISTRATION_CLOSEST_MATCHES_H
