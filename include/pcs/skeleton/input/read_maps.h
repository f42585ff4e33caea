// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the caller's property maps of points: wood, stations and normals.

#ifndef PCS_SKELETON_INPUT_READ_MAPS_H
#define PCS_SKELETON_INPUT_READ_MAPS_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/Skeleton_options.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/skeleton/input/caller_types.h>
#include <pcs/skeleton/input/check_input.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

namespace pcs {
namespace skeleton {
namespace internal {

/// Reads `wood_map`: 1 for points that may belong to a branch. Empty without a map. Throws
/// `Invalid_input` if too few points remain.
template <class PointRange, class NamedParameters>
std::vector<std::uint8_t>
read_wood(const PointRange& points, const NamedParameters& np, const std::string& caller)
{
  using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
  std::vector<std::uint8_t> is_wood;
  if constexpr (pcs::internal::is_given_v<NamedParameters, internal_np::wood_map_t>) {
    const auto map = CGAL::parameters::get_parameter(np, internal_np::wood_map);
    constexpr bool is_map_ok = is_readable_map_v<std::decay_t<decltype(map)>, Element, bool>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `wood_map` must be readable, "
                  "accept an element of `points` as key, and store bool");
    std::size_t count = 0;
    is_wood.reserve(static_cast<std::size_t>(std::end(points) - std::begin(points)));
    if constexpr (is_map_ok)
      for (auto it = std::begin(points); it != std::end(points); ++it) {
        is_wood.push_back(get(map, *it) ? 1 : 0);
        count += is_wood.back();
      }
    pcs::internal::check(count >= lowest_number_of_scan_points,
                         caller,
                         "wood_map leaves " + std::to_string(count) +
                             " points; there must be at least " +
                             std::to_string(lowest_number_of_scan_points));
  }
  return is_wood;
}

/// Reads `station_map`: the station of each point, or an empty list if no station is known.
template <class PointRange, class NamedParameters>
std::vector<long long> read_stations(const PointRange& points, const NamedParameters& np)
{
  using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
  std::vector<long long> stations;
  if constexpr (pcs::internal::is_given_v<NamedParameters, internal_np::station_map_t>) {
    const auto map = CGAL::parameters::get_parameter(np, internal_np::station_map);
    using Map = std::decay_t<decltype(map)>;
    constexpr bool is_map_ok = is_readable_map_v<Map, Element, pcs::Map_value<Map>> &&
                               std::is_integral_v<pcs::Map_value<Map>>;
    static_assert(is_map_ok,
                  "pcs::extract_tree_skeleton(): named parameter `station_map` must be readable, "
                  "accept an element of `points` as key, and store an integer type");
    if constexpr (is_map_ok) {
      const auto begin = std::begin(points), end = std::end(points);
      std::size_t i = 0;
      for (auto it = begin; it != end; ++it, ++i) {
        const long long label = static_cast<long long>(get(map, *it));
        if (label >= 0 && stations.empty())
          stations.assign(static_cast<std::size_t>(end - begin), -1);
        if (label >= 0)
          stations[i] = label;
      }
    }
  }
  return stations;
}

/// Reads the normals of the input from `normal_map` if `rules` states that there are any. Null
/// vectors and vectors that are not finite are unknown normals.
template <class PointRange, class NamedParameters>
std::vector<Vec3> read_normals(const PointRange& points,
                               const NamedParameters& np,
                               const Slice_options& rules,
                               const std::string& caller)
{
  using Element = typename Skeleton_types<PointRange, NamedParameters>::Element;
  std::vector<Vec3> normals;
  if (!rules.has_normals)
    return normals;
  constexpr bool is_given = pcs::internal::is_given_v<NamedParameters, CGAL::internal_np::normal_t>;
  bool is_read = false;
  if constexpr (is_given) {
    const auto map = CGAL::parameters::get_parameter(np, CGAL::internal_np::normal_map);
    using Map = std::decay_t<decltype(map)>;
    if constexpr (is_readable_point_map_v<Map, Element>) {
      is_read = true;
      normals.reserve(static_cast<std::size_t>(std::end(points) - std::begin(points)));
      for (auto it = std::begin(points); it != std::end(points); ++it)
        normals.push_back(to_vec3(get(map, *it)));
    }
  }
  pcs::internal::check(is_read,
                       caller,
                       "slice_options: `has_normals` needs the named parameter `normal_map` with a "
                       "readable map");
  return normals;
}

} // namespace internal
} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_INPUT_READ_MAPS_H
