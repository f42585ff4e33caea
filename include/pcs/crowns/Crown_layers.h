// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Area, volume and outline of a crown from points that are added one by one.

#ifndef PCS_CROWNS_CROWN_LAYERS_H
#define PCS_CROWNS_CROWN_LAYERS_H

#include <pcs/core/errors.h>
#include <pcs/crowns/convex_hull.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace pcs {
namespace crowns {

//! the default height of a layer [L]: half a metre
constexpr double default_layer_height = 0.5;

/*!
  \ingroup PkgPcsCoreRef
  \brief size and shape of a crown.

  There are no standard errors: a convex hull depends on single points, and how far these lie
  outside the crown is not known.
*/
struct Crown_measures
{
  std::size_t number_of_points = 0; //!< at or above the base [count]
  double area = 0;                  //!< of the convex hull of these points in the plan [L^2]
  double volume = 0;                //!< sum of area times height of all layers [L^3]
  //! corners of this hull, counter-clockwise, beginning with the smallest `x`
  std::vector<Position_2> outline;
};

/*!
  \ingroup PkgPcsCoreRef
  \brief the convex hulls of horizontal layers of a crown.

  Layer `k` has the points with heights in `[base + k h, base + (k + 1) h)`; `h` is the layer
  height. The volume is the sum of the areas of their convex hulls, times `h`. Layers whose points
  are on one line, or that have none, add nothing. Hollows of a layer count as crown.

  Points are kept only until they are inside the hull of their layer. Memory: some 16 bytes per
  corner and 1 kB per layer.

  \par Determinism
  The measures do not depend on the order of the points.
*/
class Crown_layers
{
public:
  //! `base` and `layer_height` [L]; throws `pcs::Invalid_input` unless both are finite and
  //! `layer_height > 0`
  explicit Crown_layers(double base, double layer_height = default_layer_height)
    : m_base(base), m_layer_height(layer_height)
  {
    if (!std::isfinite(base))
      throw Invalid_input("pcs::crowns::Crown_layers: the base is not finite");
    if (!(layer_height > 0 && std::isfinite(layer_height)))
      throw Invalid_input("pcs::crowns::Crown_layers: the layer height is " +
                          std::to_string(layer_height) + ", expected a positive length");
  }

  /*!
    \brief adds a point; one below the base has no effect.

    Throws `pcs::Invalid_input` if a value is not finite, or the point is more than 1e9 layers above
    the base.
  */
  void add(const Position_2& position, double height)
  {
    constexpr double most_layers = 1e9;
    if (!(std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(height)))
      throw Invalid_input("pcs::crowns::Crown_layers::add(): a coordinate is not finite");
    if (height < m_base)
      return;
    const double layer = std::floor((height - m_base) / m_layer_height);
    if (layer > most_layers)
      throw Invalid_input("pcs::crowns::Crown_layers::add(): the height " + std::to_string(height) +
                          " is more than 1e9 layers above the base");
    ++m_number_of_points;
    Layer& l = m_layers[static_cast<std::int64_t>(layer)];
    l.points.push_back(position);
    if (l.points.size() >= l.limit) {
      make_convex_hull(l.points);
      l.limit = std::max(least_limit, 2 * l.points.size());
    }
  }

  //! returns the measures of the points so far
  Crown_measures measures() const
  {
    Crown_measures result;
    result.number_of_points = m_number_of_points;
    for (const auto& layer : m_layers) {
      std::vector<Position_2> hull = layer.second.points;
      make_convex_hull(hull);
      result.volume += polygon_area(hull) * m_layer_height;
      result.outline.insert(result.outline.end(), hull.begin(), hull.end());
    }
    make_convex_hull(result.outline);
    result.area = polygon_area(result.outline);
    return result;
  }

private:
  static constexpr std::size_t least_limit = 32;

  /// The points outside the hull when it was last computed, and its corners.
  struct Layer
  {
    std::vector<Position_2> points;
    std::size_t limit = least_limit; ///< the hull is computed again at this number of points
  };

  double m_base, m_layer_height;
  std::size_t m_number_of_points = 0;
  std::map<std::int64_t, Layer> m_layers; ///< in ascending order: sums have a fixed order
};

} // namespace crowns
} // namespace pcs

#endif // PCS_CROWNS_CROWN_LAYERS_H
