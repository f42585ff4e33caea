// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Surface patches of the edges of the common topology.

#ifndef PCS_SHAPE_SPACE_POINTS_SURFACE_PATCHES_H
#define PCS_SHAPE_SPACE_POINTS_SURFACE_PATCHES_H

#include <pcs/shape_space/model/Common_topology.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/points/assign_points.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Converts the edges of a tree to tubes. `has(b)`: whether the tree has branch `b`.
template <class Has>
std::vector<Tube> make_tubes(const Orl_layout& layout,
                             const Orl_geometry& geometry,
                             const Vec3& shift,
                             const Has& has,
                             std::vector<std::size_t>& edge_of_tube)
{
  std::vector<Tube> tubes;
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; has(b) && j < layout.branches[b].number_of_edges; ++j) {
      const std::size_t v = layout.first_node(b) + j;
      tubes.push_back({geometry.node[v] + shift,
                       geometry.node[v + 1] + shift,
                       geometry.radius[v],
                       geometry.radius[v + 1],
                       b});
      edge_of_tube.push_back(layout.branches[b].first_edge + j);
    }
  return tubes;
}

inline std::vector<Tube> make_tubes(const Orl_layout& layout,
                                    const Common_topology& topology,
                                    const Orl_geometry& geometry,
                                    std::size_t tree,
                                    const Vec3& shift,
                                    std::vector<std::size_t>& edge_of_tube)
{
  return make_tubes(
      layout,
      geometry,
      shift,
      [&](std::size_t b) { return !topology.branches[b].is_virtual(static_cast<int>(tree)); },
      edge_of_tube);
}

/// Marks the edges whose radius is known at both ends in each tree that has them. For these edges,
/// detail is stored in units of the radius. `has(t, b)`: whether tree `t` has branch `b`.
template <class Geometries, class Has>
std::vector<char>
edges_with_radius(const Orl_layout& layout, const Geometries& geometry, const Has& has)
{
  std::vector<char> result(layout.number_of_edges(), 1);
  for (std::size_t b = 0; b < layout.branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
      for (std::size_t t = 0; t < geometry.size(); ++t) {
        const std::size_t v = layout.first_node(b) + j;
        const double least = std::min(geometry[t].radius[v], geometry[t].radius[v + 1]);
        const double most = std::max(geometry[t].radius[v], geometry[t].radius[v + 1]);
        if (has(t, b) && !(least > 1e-3 * most))
          result[layout.branches[b].first_edge + j] = 0;
      }
  return result;
}

inline std::vector<char> edges_with_radius(const Orl_layout& layout,
                                           const Common_topology& topology,
                                           const std::array<Orl_geometry, 2>& geometry)
{
  return edges_with_radius(layout, geometry, [&](std::size_t t, std::size_t b) {
    return !topology.branches[b].is_virtual(static_cast<int>(t));
  });
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_SURFACE_PATCHES_H
