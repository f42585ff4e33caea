// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Deformation of points that do not belong to the session.

#ifndef PCS_DEFORMATION_ACCESS_CARRY_POINTS_H
#define PCS_DEFORMATION_ACCESS_CARRY_POINTS_H

#include <pcs/core/parameters/check_value.h>
#include <pcs/deformation/access/Point_access.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

template <class ConcurrencyTag, class Session, class Access>
void carry_points(Session& session, Access& access, const char* function)
{
  const std::vector<Vec3> rest = access.template points<ConcurrencyTag>(function);
  access.check_attributes(function);
  pcs::internal::check(!session.is_ahead_of_shape(),
                       function,
                       "handles were added or removed since the last deform(); call it first");
  session.prepare_carrying();
  const auto carry = [&](std::size_t i) {
    const Vec3 rest_normal = access.normal(i);
    Vec3 p = rest[i], normal = rest_normal;
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
    session.carry(p, normal, gradient);
    bool is_changed = p != rest[i] || normal != rest_normal; // a normal may rotate at a fixed point
    if constexpr (Access::has_gradient_map)
      is_changed = is_changed || gradient != Eigen::Matrix3d::Identity();
    if (is_changed)
      access.write(i, p, normal, gradient);
  };
  pcs::internal::for_each_index<ConcurrencyTag>(rest.size(), carry, 256);
}

} // namespace internal

/// Moves `points` as the current shape of the session moves the points around them. Throws
/// `Invalid_input` before anything changes.
template <class ConcurrencyTag, class Session, class PointRange, class NamedParameters>
void carry_points(Session& session,
                  PointRange& points,
                  const NamedParameters& np,
                  const char* function)
{
  using Access = Point_access<PointRange, NamedParameters>;
  static_assert(!Access::has_vectors && !Access::has_tensors,
                "pcs::Point_set_deformation::apply(): `vector_map` and `tensor_map` are for the "
                "points of the object itself");
  if constexpr (Access::is_ok) {
    Access access(points, np);
    internal::carry_points<ConcurrencyTag>(session, access, function);
  }
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_ACCESS_CARRY_POINTS_H
