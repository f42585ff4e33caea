// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Positions at rest in the caller's coordinates, with all their bits.

#ifndef PCS_DEFORMATION_UPSAMPLING_REST_POSITIONS_H
#define PCS_DEFORMATION_UPSAMPLING_REST_POSITIONS_H

#include <pcs/deformation/model/Local_frame.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// The positions at rest by input index. The conversion to local coordinates and back rounds, so
/// they are stored, 24 bytes each, unless it returns all bits of every point. That is usual for
/// coordinates in single precision.
class Rest_positions
{
public:
  /// Must be called again for each new rest shape.
  void keep(const Local_frame& frame, std::vector<Vec3> points)
  {
    m_points.clear();
    for (const Vec3& p : points) {
      const Vec3 returned = frame.to_world(frame.to_local(p));
      if (std::memcmp(returned.data(), p.data(), 3 * sizeof(double)) != 0) {
        m_points = std::move(points);
        break;
      }
    }
    m_points.shrink_to_fit();
  }

  /// Returns the position of point `i`. \param convert returns it from the local coordinates
  template <class Convert>
  Vec3 operator()(std::size_t i, const Convert& convert) const
  {
    return m_points.empty() ? convert() : m_points[i];
  }

private:
  std::vector<Vec3> m_points;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_UPSAMPLING_REST_POSITIONS_H
