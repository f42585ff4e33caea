// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Families of trees from their topology, and embedding of further trees.

#ifndef PCS_SHAPE_SPACE_FAMILY_MAKE_FAMILY_H
#define PCS_SHAPE_SPACE_FAMILY_MAKE_FAMILY_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/family/Shared_topology_builder.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/measures/Tree_descriptors.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/pair/Embedded_pair.h>
#include <pcs/shape_space/points/assign_points.h>
#include <pcs/shape_space/points/surface_patches.h>

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

inline void find_growth_direction(Tree_family& family)
{
  Vec3 sum = Vec3::Zero();
  Orl_geometry geometry;
  for (const Orl_coordinates& x : family.x) {
    build_geometry(family.layout, x, family.orientation, geometry);
    sum += growth_direction(family.layout, x, geometry).stableNormalized();
  }
  family.up = sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3(Vec3::UnitZ());
}

/// Converts the orientations of a tree, between frames and world axes, to the kind `kind`.
inline void measure_as(Orl_orientation kind, const Orl_layout& layout, Orl_coordinates& x)
{
  Orl_geometry geometry;
  build_geometry(layout,
                 x,
                 kind == Orl_orientation::world_axes ? Orl_orientation::gauge_fixed
                                                     : Orl_orientation::world_axes,
                 geometry);
  for (std::size_t e = 0; e < layout.number_of_edges(); ++e)
    if (const std::size_t p = layout.parent_edge[e]; p != none)
      x.orientation[e] = relative(kind, geometry.frame[p], geometry.frame[e]);
}

} // namespace internal

/// Makes a family of two trees; `first_point` is left to the caller.
inline Tree_family make_family(const Embedded_pair& pair,
                               const std::array<const Tree_input*, 2>& inputs,
                               const Matching_weights& weights)
{
  Tree_family family;
  family.orientation = pair.form.orientation;
  family.layout = pair.layout;
  family.x.assign(pair.x.begin(), pair.x.end());
  family.weights = pair.weights;
  family.origin = inputs[0]->tree.origin;
  family.matching = weights;
  for (std::size_t t = 0; t < 2; ++t) {
    family.has.emplace_back();
    family.tip.emplace_back();
    for (const Common_branch& b : pair.topology.branches) {
      family.has[t].push_back(b.path[t] != none);
      family.tip[t].push_back(
          b.path[t] == none
              ? none
              : inputs[t]->tree.sources[pair.topology.paths[t].paths[b.path[t]].tip()]);
    }
  }
  for (const Common_branch& b : pair.topology.branches)
    family.confidence.push_back(b.confidence);
  coordinates_at(pair.layout, pair.x[0], pair.x[1], 0.5, 0, family.reference);
  for (std::size_t b = 0; b < pair.layout.branches.size(); ++b)
    for (std::size_t t = 0; t < 2; ++t)
      if (!family.has[1 - t][b]) {
        const Orl_layout::Branch& branch = pair.layout.branches[b];
        family.reference.base_radius[b] = pair.x[t].base_radius[b];
        family.reference.attachment[b] = pair.x[t].attachment[b];
        for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges;
             ++e) {
          family.reference.orientation[e] = pair.x[t].orientation[e];
          family.reference.length[e] = pair.x[t].length[e];
          family.reference.radius[e] = pair.x[t].radius[e];
        }
      }
  if (family.orientation == Orl_orientation::world_axes)
    internal::measure_as(Orl_orientation::gauge_fixed, family.layout, family.reference);
  internal::find_growth_direction(family);
  return family;
}

/// Makes a family of any number of trees on their topology.
template <class ConcurrencyTag>
Tree_family make_family(Shared_topology_builder<ConcurrencyTag>& topology,
                        const std::vector<const Rooted_tree*>& trees,
                        const Matching_weights& weights,
                        const Representation_options& form)
{
  const Orl_orientation orientation = form.orientation;
  Tree_family family;
  family.orientation = orientation;
  family.matching = weights;
  family.origin = trees[0]->origin;
  const std::vector<Shared_branch>& branches = topology.branches();
  family.layout = make_layout(branches);
  set_parent_edges(family.layout, orientation);
  Embedded_trees embedded = embed_trees<ConcurrencyTag>(family.layout,
                                                        branches,
                                                        trees,
                                                        topology.paths(),
                                                        topology.reference(),
                                                        orientation,
                                                        form.direction);
  family.x = std::move(embedded.x);
  // further trees are matched to a reference tree in frames, for every kind of orientation
  family.reference =
      orientation == Orl_orientation::gauge_fixed
          ? std::move(embedded.reference)
          : internal::with_parent_edges(make_layout(branches), topology.reference(), family.layout);
  family.weights = make_weights(family.layout, family.x, form.has_unit_weights);
  for (std::size_t t = 0; t < trees.size(); ++t) {
    family.has.emplace_back();
    family.tip.emplace_back();
    for (const Shared_branch& b : branches) {
      family.has[t].push_back(b.has(t));
      family.tip[t].push_back(
          b.has(t) ? trees[t]->sources[topology.paths()[t].paths[b.path[t]].tip()] : none);
    }
  }
  internal::find_growth_direction(family);
  return family;
}

/// Returns the first pair of each edge, and the number of pairs as last element.
inline std::vector<std::size_t> first_of_edges(const std::vector<Point_pair>& pairs,
                                               std::size_t number_of_edges)
{
  std::vector<std::size_t> first(number_of_edges + 1, 0);
  for (const Point_pair& p : pairs)
    ++first[p.edge + 1];
  for (std::size_t e = 0; e < number_of_edges; ++e)
    first[e + 1] += first[e];
  return first;
}

/// Finds the edge of each point of tree `t`.
template <class ConcurrencyTag>
std::vector<std::size_t> edges_of_points(const Tree_family& family,
                                         const Tree_input& input,
                                         std::size_t t,
                                         const Orl_geometry& geometry,
                                         const Point_assignment_options& options)
{
  const Orl_layout& layout = family.layout;
  const Vec3 shift = family.origin - input.tree.origin;
  std::vector<std::size_t> edge_of_tube;
  const std::vector<Tube> tubes = make_tubes(
      layout,
      geometry,
      shift,
      [&](std::size_t b) { return family.has[t][b] != 0; },
      edge_of_tube);
  std::vector<std::size_t> result =
      assign_points<ConcurrencyTag>(input.points, input.normals, tubes, input.tree.extent, options);
  for (std::size_t& e : result)
    e = edge_of_tube[e];
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_MAKE_FAMILY_H
