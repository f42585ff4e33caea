// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Area, volume and outline of the crown of a tree.

#ifndef PCS_CROWNS_MEASURE_CROWN_H
#define PCS_CROWNS_MEASURE_CROWN_H

#include <pcs/Named_function_parameters.h>
#include <pcs/concepts.h>
#include <pcs/core/parameters/read_parameter.h>
#include <pcs/crowns/Crown_layers.h>

#include <CGAL/number_utils.h>
#include <CGAL/property_map.h>

#include <iterator>
#include <type_traits>

namespace pcs {
namespace crowns {

/*!
  \ingroup PkgPcsCoreRef
  \brief measures the crown of a tree from its points.

  The area is that of the convex hull, in the plan, of the points at or above `base`: the crown
  projection area. The points are divided into horizontal layers. The volume is the sum of the areas
  of the convex hulls of the layers, times `layer_height`. Thin layers follow the shape closely, but
  need more points. Hollows of a layer count as crown, so both are upper bounds for lobed crowns. A
  single stray point enlarges them, so the points of the tree should have no outliers.

  Up is +z. For another direction, pass a `point_map` that exchanges coordinates.

  \tparam PointRange a model of `ConstRange`, `n` elements
  \tparam NamedParameters a sequence of named parameters
  \param points the points of one tree
  \param base the height from which points belong to the crown, in coordinates of the input [L]: for
         example breast height above the foot, so that the stem base and shrubs do not count
  \param layer_height height of a layer [L], `> 0`
  \param np an optional sequence of named parameters, listed below
  \npbegin
    \np{point_map} where a position is read
      \nptype model of `ReadablePropertyMap`, key: element of `points`, value: a point
      \npdefault `CGAL::Identity_property_map`
  \npend
  \return area, volume, outline and number of points; all 0 if no point is above the base. There are
          no standard errors, see `Crown_measures`
  \throws pcs::Invalid_input when a coordinate or `base` is not finite, or `layer_height` is not
          positive
  \par Complexity
  \f$O(n \log n)\f$ at most, \f$O(n)\f$ if few points are corners. Memory for the corners only.
  \par Determinism
  The result does not depend on the order of the points.
*/
template <class PointRange, class NamedParameters = parameters::Default_named_parameters>
Crown_measures measure_crown(const PointRange& points,
                             double base,
                             double layer_height = default_layer_height,
                             const NamedParameters& np = parameters::default_values())
{
  constexpr bool is_range_ok =
      !std::is_void_v<typename pcs::internal::Iterator_of<const PointRange>::type>;
  static_assert(is_range_ok,
                "pcs::crowns::measure_crown(): the points must be a range, for example a "
                "std::vector");
  pcs::internal::check_names<CGAL::internal_np::point_t>(np);
  Crown_layers layers(base, layer_height);
  if constexpr (is_range_ok) {
    using Element = Element_reference<const PointRange>;
    const auto point_map =
        pcs::internal::choose(np,
                              CGAL::internal_np::point_map,
                              CGAL::Identity_property_map<std::decay_t<Element>>());
    using Point_map = std::decay_t<decltype(point_map)>;
    using Point = Map_value<Point_map>;
    constexpr bool is_map_ok =
        is_coordinate_triple_v<Point> && is_readable_map_v<Point_map, Element, Point>;
    static_assert(is_map_ok,
                  "pcs::crowns::measure_crown(): named parameter `point_map` must be readable, "
                  "accept an element of `points` as key, and store points with x(), y(), z()");
    if constexpr (is_map_ok)
      for (auto it = std::begin(points); it != std::end(points); ++it) {
        const Point& p = get(point_map, *it);
        layers.add({CGAL::to_double(p.x()), CGAL::to_double(p.y())}, CGAL::to_double(p.z()));
      }
  }
  return layers.measures();
}

} // namespace crowns
} // namespace pcs

#endif // PCS_CROWNS_MEASURE_CROWN_H
