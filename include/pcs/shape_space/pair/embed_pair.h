// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Embedding of two trees on their common topology, and assignment of their points.

#ifndef PCS_SHAPE_SPACE_PAIR_EMBED_PAIR_H
#define PCS_SHAPE_SPACE_PAIR_EMBED_PAIR_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/embedding/embed_trees.h>
#include <pcs/shape_space/embedding/skip_fold_edges.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/pair/Embedded_pair.h>
#include <pcs/shape_space/points/assign_points.h>
#include <pcs/shape_space/points/surface_patches.h>

#include <array>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Computes everything but the instances from the topology.
inline void embed(const std::array<const Tree_input*, 2>& inputs, Embedded_pair& pair)
{
  pair.layout = make_layout(pair.topology.branches);
  std::vector<std::vector<Vec3>> directions;
  for (int t = 0; t < 2; ++t)
    directions.push_back(internal::embed(pair.layout,
                                         pair.topology.branches,
                                         inputs[static_cast<std::size_t>(t)]->tree,
                                         pair.topology.paths[static_cast<std::size_t>(t)],
                                         t,
                                         Vec3::Zero())
                             .direction);
  skip_fold_edges(directions, pair.layout);
  set_parent_edges(pair.layout, pair.form.orientation);
  pair.x = embed_trees(pair.layout,
                       pair.topology.branches,
                       {&inputs[0]->tree, &inputs[1]->tree},
                       pair.topology.paths,
                       pair.form.orientation,
                       pair.form.direction,
                       pair.rotation);
  for (std::size_t t = 0; t < 2; ++t)
    build_geometry(pair.layout, pair.x[t], pair.form.orientation, pair.geometry[t]);
  pair.weights = make_weights(pair.layout, pair.x, pair.form.has_unit_weights);
  pair.is_relative = edges_with_radius(pair.layout, pair.topology, pair.geometry);
}

/// Returns the points of the second tree in the local coordinates of the first. [L]
inline std::vector<Vec3> points_of_second(const std::array<const Tree_input*, 2>& inputs)
{
  const Vec3 shift = inputs[1]->tree.origin - inputs[0]->tree.origin;
  std::vector<Vec3> points(inputs[1]->points);
  for (Vec3& p : points)
    p += shift;
  return points;
}

/// Finds the edge of each point of tree `t`.
template <class ConcurrencyTag>
std::vector<std::size_t> edges_of_points(const std::array<const Tree_input*, 2>& inputs,
                                         const Embedded_pair& pair,
                                         std::size_t t,
                                         const Point_assignment_options& options)
{
  std::vector<std::size_t> edge_of_tube;
  const Vec3 shift =
      t == 0 ? Vec3(Vec3::Zero()) : Vec3(inputs[0]->tree.origin - inputs[1]->tree.origin);
  const std::vector<Tube> tubes =
      make_tubes(pair.layout, pair.topology, pair.geometry[t], t, shift, edge_of_tube);
  std::vector<std::size_t> result = assign_points<ConcurrencyTag>(inputs[t]->points,
                                                                  inputs[t]->normals,
                                                                  tubes,
                                                                  inputs[t]->tree.extent,
                                                                  options);
  for (std::size_t& e : result)
    e = edge_of_tube[e];
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PAIR_EMBED_PAIR_H
