// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writing of points and normals of a tree to the ranges and maps of a caller.

#ifndef PCS_SHAPE_SPACE_POINTS_WRITE_POINTS_H
#define PCS_SHAPE_SPACE_POINTS_WRITE_POINTS_H

#include <pcs/concepts.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>

namespace pcs {
namespace shape_space {

template <class Triple>
Triple to_triple(const Vec3& v)
{
  using Number = std::decay_t<decltype(std::declval<const Triple&>().x())>;
  return Triple(static_cast<Number>(v.x()), static_cast<Number>(v.y()), static_cast<Number>(v.z()));
}

/// Replaces a property map that was not given.
struct No_map
{
};

/// Writes point `i` to element `i` of a range through property maps. `NormalMap` is
/// `No_map` without normals.
template <class Iterator, class PointMap, class NormalMap>
struct Point_writer
{
  Iterator begin;
  PointMap point_map;
  NormalMap normal_map;
  Vec3 origin; ///< of the coordinates of the space [L]

  void operator()(std::size_t i, const Vec3& position, const Vec3& normal, std::size_t) const
  {
    auto&& key = *(begin + static_cast<std::ptrdiff_t>(i));
    put(point_map, key, to_triple<Map_value<PointMap>>(position + origin));
    if constexpr (!std::is_same_v<NormalMap, No_map>)
      put(normal_map, key, to_triple<Map_value<NormalMap>>(normal));
    else
      static_cast<void>(normal);
  }
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_WRITE_POINTS_H
