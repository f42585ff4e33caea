// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Coordinates of two trees on their common topology, with the twist of frames minimised.

#ifndef PCS_SHAPE_SPACE_EMBEDDING_EMBED_TREES_H
#define PCS_SHAPE_SPACE_EMBEDDING_EMBED_TREES_H

#include <pcs/core/Orl_options.h>
#include <pcs/shape_space/embedding/Branch_turns.h>
#include <pcs/shape_space/embedding/Embedding.h>
#include <pcs/shape_space/model/Common_topology.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Lays out the edges of the common topology. Orientations at a fork refer to the edge before the
/// mean attachment.
inline Orl_layout make_layout(const std::vector<Common_branch>& branches)
{
  Orl_layout layout;
  for (const Common_branch& b : branches) {
    Orl_layout::Branch branch;
    branch.parent = b.parent;
    branch.first_edge = layout.number_of_edges();
    branch.number_of_edges = b.number_of_nodes() - 1;
    if (b.parent != none) {
      const Orl_layout::Branch& parent = layout.branches[b.parent];
      const double t = std::ceil(0.5 * (b.attachment[0] + b.attachment[1])) - 1;
      branch.reference_edge =
          parent.first_edge +
          std::min(parent.number_of_edges - 1, static_cast<std::size_t>(std::max(0.0, t)));
    }
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      layout.edge_before.push_back(j == 0 ? branch.reference_edge : branch.first_edge + j - 1);
    layout.branches.push_back(branch);
  }
  set_parent_edges(layout, Orl_orientation::gauge_fixed);
  return layout;
}

namespace internal {

/// Returns the radius of a path at its node `k`. If the radius at the base of a branch is unknown,
/// it is at most the radius at the end of its first edge. [L]
inline double path_radius(const Rooted_tree& tree, const Branch_path& path, std::size_t k)
{
  const std::size_t v = path.nodes[k];
  if (k > 0 || path.is_trunk || path.is_continued)
    return tree.radii[v];
  const std::size_t w = path.nodes[1];
  return std::isfinite(tree.base_radii[w]) ? tree.base_radii[w]
                                           : std::min(tree.radii[v], tree.radii[w]);
}

/// Returns position and radius at a fraction of the length of a path. [L]
inline std::pair<Vec3, double>
node_at(const Rooted_tree& tree, const Branch_path& path, double fraction)
{
  const double s = fraction * path.length();
  const auto it = std::lower_bound(path.arc.begin(), path.arc.end(), s);
  auto k = static_cast<std::size_t>(it - path.arc.begin());
  k = std::min(k, path.arc.size() - 1);
  // a position near a node is moved to the node
  for (const std::size_t i : {k, k > 0 ? k - 1 : k})
    if (std::abs(path.arc[i] - s) <= 1e-12 * path.length())
      return {tree.points[path.nodes[i]], path_radius(tree, path, i)};
  const double f = (s - path.arc[k - 1]) / (path.arc[k] - path.arc[k - 1]);
  return {(1 - f) * tree.points[path.nodes[k - 1]] + f * tree.points[path.nodes[k]],
          (1 - f) * path_radius(tree, path, k - 1) + f * path_radius(tree, path, k)};
}

inline Embedding embed(const Orl_layout& layout,
                       const std::vector<Common_branch>& branches,
                       const Rooted_tree& tree,
                       const Branch_paths& paths,
                       int t,
                       const Vec3& shift)
{
  Embedding result = empty_embedding(layout, tree.points[0] + shift);
  Orl_coordinates& x = result.x;
  const auto i = static_cast<std::size_t>(t);
  for (std::size_t b = 0; b < branches.size(); ++b) {
    x.attachment[b] = branches[b].attachment[i];
    if (branches[b].is_virtual(t))
      continue;
    const Branch_path& path = paths.paths[branches[b].path[i]];
    auto [from, radius] = node_at(tree, path, 0);
    x.base_radius[b] = radius;
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j) {
      const std::size_t e = layout.branches[b].first_edge + j;
      const auto [to, end_radius] = node_at(tree, path, branches[b].node[i][j + 1]);
      x.radius[e] = end_radius;
      set_edge(to - from, shortest_edge * tree.extent, x.length[e], result.direction[e]);
      from = to;
    }
    lend_directions(layout.branches[b], result.direction);
  }
  return result;
}

/// Computes orientations from frames; edges that a tree lacks have the orientations of `other`.
inline void set_orientations(const Orl_layout& layout,
                             const std::vector<Common_branch>& branches,
                             Orl_orientation kind,
                             Virtual_direction direction,
                             int t,
                             const Embedding& other,
                             Embedding& tree)
{
  const auto own = [&](const Embedding& x, std::size_t e) {
    const std::size_t p = layout.parent_edge[e];
    return p == none ? x.frame[e] : relative(kind, x.frame[p], x.frame[e]);
  };
  for (std::size_t b = 0; b < branches.size(); ++b)
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j) {
      const std::size_t e = layout.branches[b].first_edge + j;
      const bool is_first_virtual =
          j == 0 && branches[b].is_virtual(t) && !branches[branches[b].parent].is_virtual(t);
      if (tree.x.length[e] > 0)
        tree.x.orientation[e] = own(tree, e);
      else if (is_first_virtual && direction == Virtual_direction::along_parent)
        tree.x.orientation[e] = Quaternion::Identity();
      else
        tree.x.orientation[e] = own(other, e);
    }
}

} // namespace internal

/// Computes the coordinates of both trees; `rotation` aligns tree 2 with tree 1.
inline std::array<Orl_coordinates, 2> embed_trees(const Orl_layout& layout,
                                                  const std::vector<Common_branch>& branches,
                                                  const std::array<const Rooted_tree*, 2>& trees,
                                                  const std::array<Branch_paths, 2>& paths,
                                                  Orl_orientation kind,
                                                  Virtual_direction direction,
                                                  const Quaternion& rotation)
{
  using namespace internal;
  const Vec3 shift = trees[1]->origin - trees[0]->origin;
  Embedding one = embed(layout, branches, *trees[0], paths[0], 0, Vec3::Zero());
  Embedding two = embed(layout, branches, *trees[1], paths[1], 1, shift);
  if (kind == Orl_orientation::world_axes) {
    // v_c = q v_p q^-1 with the shortest rotation q in the axes of the input; the frame of an edge
    // is the product of the rotations q from the root to the edge
    for (Embedding* tree : {&one, &two})
      for (std::size_t e = 0; e < layout.number_of_edges(); ++e)
        if (tree->x.length[e] > 0) {
          const std::size_t p = layout.parent_edge[e];
          const Quaternion parent = p == none ? Quaternion::Identity() : tree->frame[p];
          tree->frame[e] = shortest_turn(parent * Vec3::UnitZ(), tree->direction[e]) * parent;
          tree->frame[e].normalize();
        }
  } else {
    // the trunk of tree 2 refers to the trunk of tree 1, so the poses of both trees in the axes of
    // the input do not matter
    set_frames(layout, Quaternion::Identity(), one);
    set_frames(layout, rotation.conjugate() * one.frame[0], two);
    if (kind == Orl_orientation::gauge_fixed)
      turn_frames(layout, one, rotation.conjugate(), two);
  }
  set_orientations(layout, branches, kind, direction, 0, two, one);
  set_orientations(layout, branches, kind, direction, 1, one, two);
  return {std::move(one.x), std::move(two.x)};
}

/// Returns weights by which all coordinates become lengths. The weight of a rotation is the mean
/// length of its edge, that of an attachment the mean length of the edges of the parent [L]. All
/// other weights are 1. If `is_published`, all weights are 1 [Aiteanu 2022]. `trees`: a range of
/// `Orl_coordinates`.
template <class Trees>
Orl_weights make_weights(const Orl_layout& layout, const Trees& trees, bool is_published)
{
  Orl_weights w;
  const std::size_t n = layout.number_of_edges(), m = layout.branches.size();
  w.orientation.assign(n, 1);
  w.length.assign(n, 1);
  w.radius.assign(n, 1);
  w.base_radius.assign(m, 1);
  w.attachment.assign(m, 1);
  if (is_published)
    return w;
  for (std::size_t e = 0; e < n; ++e) {
    double sum = 0;
    for (const Orl_coordinates& x : trees)
      sum += x.length[e];
    w.orientation[e] = sum / static_cast<double>(trees.size());
  }
  for (std::size_t b = 0; b < m; ++b)
    if (const std::size_t p = layout.branches[b].parent; p != none) {
      double length = 0;
      for (std::size_t j = 0; j < layout.branches[p].number_of_edges; ++j)
        length += w.orientation[layout.branches[p].first_edge + j];
      w.attachment[b] = length / static_cast<double>(layout.branches[p].number_of_edges);
    }
  return w;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_EMBED_TREES_H
