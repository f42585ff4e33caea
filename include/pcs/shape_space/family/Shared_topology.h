// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Common topology of any number of trees, and their coordinates on it.

#ifndef PCS_SHAPE_SPACE_FAMILY_SHARED_TOPOLOGY_H
#define PCS_SHAPE_SPACE_FAMILY_SHARED_TOPOLOGY_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/embedding/embed_trees.h>
#include <pcs/shape_space/embedding/mean_rotation.h>
#include <pcs/shape_space/family/Reference_tree.h>
#include <pcs/shape_space/matching/elastic_curves.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// A branch of the topology of many trees. Its nodes divide the branch into corresponding parts in
/// all trees. Between nodes, branches are straight, so that a bend has the same parameter in all
/// trees.
struct Shared_branch
{
  std::size_t parent = none; ///< index of an earlier branch, or `none`
  std::size_t number_of_edges = 1;
  std::size_t reference_edge = 0;        ///< edge of the parent, counted from its first
  std::vector<std::size_t> path;         ///< per tree, `none`: the tree does not have the branch
  std::vector<std::vector<double>> node; ///< per tree: fractions of the length; empty: none
  std::vector<double>
      attachment; ///< per tree: number of a node of the parent, plus the fraction of the next edge

  bool has(std::size_t tree) const { return path[tree] != none; }
  std::size_t number_of_members() const
  {
    return path.size() - static_cast<std::size_t>(std::count(path.begin(), path.end(), none));
  }
};

/// Largest distance of an axis from the straight edges between its nodes, as a fraction of the
/// length of the branch. [-]
constexpr double axis_tolerance = 0.01;

/// Returns the least of several numbers of straight edges that approximate a path within
/// `axis_tolerance`. [count]
inline std::size_t number_of_straight_edges(const Rooted_tree& tree, const Branch_path& path)
{
  constexpr std::size_t steps[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32};
  for (const std::size_t n : steps) {
    double worst = 0;
    for (std::size_t k = 0; k < path.nodes.size(); ++k) {
      const double s = path.arc[k] / path.length() * static_cast<double>(n);
      const auto i = std::min(n - 1, static_cast<std::size_t>(s));
      const double step = path.length() / static_cast<double>(n);
      const Vec3 a = point_at(tree, path, step * static_cast<double>(i));
      const Vec3 v = point_at(tree, path, step * static_cast<double>(i + 1)) - a;
      const Vec3 p = tree.points[path.nodes[k]] - a;
      const double t =
          v.squaredNorm() > 0 ? std::min(1.0, std::max(0.0, p.dot(v) / v.squaredNorm())) : 0;
      worst = std::max(worst, (p - t * v).norm());
    }
    if (worst <= axis_tolerance * path.length())
      return n;
  }
  return steps[9];
}

inline Orl_layout make_layout(const std::vector<Shared_branch>& branches)
{
  Orl_layout layout;
  for (const Shared_branch& b : branches) {
    Orl_layout::Branch branch;
    branch.parent = b.parent;
    branch.first_edge = layout.number_of_edges();
    branch.number_of_edges = b.number_of_edges;
    if (b.parent != none)
      branch.reference_edge = layout.branches[b.parent].first_edge + b.reference_edge;
    for (std::size_t j = 0; j < branch.number_of_edges; ++j)
      layout.edge_before.push_back(j == 0 ? branch.reference_edge : branch.first_edge + j - 1);
    layout.branches.push_back(branch);
  }
  set_parent_edges(layout, Orl_orientation::gauge_fixed);
  return layout;
}

namespace internal {

/// Returns the number of the edge before an attachment.
inline std::size_t edge_before(double attachment, std::size_t number_of_edges)
{
  const double t = std::max(0.0, std::ceil(attachment) - 1);
  return std::min(number_of_edges - 1, static_cast<std::size_t>(t));
}

/// Embeds tree `t`: lengths, radii, attachments and directions; empty for branches that it lacks.
inline Embedding embed(const Orl_layout& layout,
                       const std::vector<Shared_branch>& branches,
                       const Rooted_tree& tree,
                       const Branch_paths& paths,
                       std::size_t t,
                       const Vec3& shift)
{
  Embedding result = empty_embedding(layout, tree.points[0] + shift);
  Orl_coordinates& x = result.x;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    if (!branches[b].has(t))
      continue;
    x.attachment[b] = branches[b].attachment[t];
    const Branch_path& path = paths.paths[branches[b].path[t]];
    auto [from, radius] = node_at(tree, path, 0);
    x.base_radius[b] = radius;
    for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j) {
      const std::size_t e = layout.branches[b].first_edge + j;
      const auto [to, end_radius] = node_at(tree, path, branches[b].node[t][j + 1]);
      x.radius[e] = end_radius;
      set_edge(to - from, shortest_edge * tree.extent, x.length[e], result.direction[e]);
      from = to;
    }
    lend_directions(layout.branches[b], result.direction);
  }
  return result;
}

inline void set_world_frames(const Orl_layout& layout, Embedding& tree)
{
  for (std::size_t e = 0; e < layout.number_of_edges(); ++e)
    if (tree.x.length[e] > 0) {
      const std::size_t p = layout.parent_edge[e];
      const Quaternion parent = p == none ? Quaternion::Identity() : tree.frame[p];
      tree.frame[e] = shortest_turn(parent * Vec3::UnitZ(), tree.direction[e]) * parent;
      tree.frame[e].normalize();
    }
}

/// Computes the orientations of the edges of a tree from its frames.
inline void set_own_orientations(const Orl_layout& layout, Orl_orientation kind, Embedding& tree)
{
  for (std::size_t e = 0; e < layout.number_of_edges(); ++e)
    if (tree.x.length[e] > 0) {
      const std::size_t p = layout.parent_edge[e];
      tree.x.orientation[e] =
          p == none ? tree.frame[e] : relative(kind, tree.frame[p], tree.frame[e]);
    }
}

/// Returns the coordinates of a tree with the frames and directions of its edges.
inline Embedding as_embedding(const Orl_layout& layout, const Orl_coordinates& x)
{
  Embedding result;
  result.x = x;
  Orl_geometry geometry;
  build_geometry(layout, x, Orl_orientation::gauge_fixed, geometry);
  result.frame = geometry.frame;
  for (const Quaternion& q : result.frame)
    result.direction.push_back(q * Vec3::UnitZ());
  return result;
}

/// Converts a tree to a layout in which orientations refer to other edges.
inline Orl_coordinates
with_parent_edges(const Orl_layout& from, const Orl_coordinates& x, const Orl_layout& to)
{
  Embedding result = as_embedding(from, x);
  for (std::size_t e = 0; e < to.number_of_edges(); ++e)
    if (const std::size_t p = to.parent_edge[e]; p != none)
      result.x.orientation[e] =
          relative(Orl_orientation::gauge_fixed, result.frame[p], result.frame[e]);
  return std::move(result.x);
}

/*!
  Computes the reference tree: for each branch, medians of lengths, radii and attachments, and L1
  means of orientations, of the trees that have the branch.
*/
template <class ConcurrencyTag>
Orl_coordinates middle_of_members(const Orl_layout& layout,
                                  const std::vector<Shared_branch>& branches,
                                  const std::vector<Embedding>& trees)
{
  Orl_coordinates x = trees.front().x;
  pcs::internal::for_each_index<ConcurrencyTag>(
      branches.size(),
      [&](std::size_t b) {
        std::vector<std::size_t> members;
        for (std::size_t t = 0; t < trees.size(); ++t)
          if (branches[b].has(t))
            members.push_back(t);
        std::vector<double> values(members.size());
        const auto of_members = [&](const auto& get) {
          for (std::size_t i = 0; i < members.size(); ++i)
            values[i] = get(trees[members[i]].x);
          return pcs::internal::mean_median(values);
        };
        x.base_radius[b] = of_members([&](const Orl_coordinates& y) { return y.base_radius[b]; });
        x.attachment[b] = of_members([&](const Orl_coordinates& y) { return y.attachment[b]; });
        std::vector<Quaternion> q(members.size());
        const std::size_t first = layout.branches[b].first_edge;
        for (std::size_t e = first; e < first + layout.branches[b].number_of_edges; ++e) {
          x.length[e] = of_members([&](const Orl_coordinates& y) { return y.length[e]; });
          x.radius[e] = of_members([&](const Orl_coordinates& y) { return y.radius[e]; });
          for (std::size_t i = 0; i < members.size(); ++i)
            q[i] = trees[members[i]].x.orientation[e];
          x.orientation[e] = l1_mean_rotation(q, std::vector<double>(q.size(), 1));
        }
      },
      8);
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const Embedding& tree : trees)
      values.push_back(tree.x.root[i]);
    x.root[i] = pcs::internal::mean_median(values);
  }
  return x;
}

} // namespace internal

/// Trees on a shared topology.
struct Embedded_trees
{
  std::vector<Orl_coordinates> x; ///< of each tree
  Orl_coordinates reference;      ///< medians over the trees that have each branch
};

/*!
  Computes the coordinates of all trees. Twists of frames follow the reference tree, so that
  twists are no differences between trees. A branch that a tree lacks has the length 0. It has the
  orientation and attachment of the reference tree, which leave the medians unchanged.
*/
template <class ConcurrencyTag>
Embedded_trees embed_trees(const Orl_layout& layout,
                           const std::vector<Shared_branch>& branches,
                           const std::vector<const Rooted_tree*>& trees,
                           const std::vector<Branch_paths>& paths,
                           const Orl_coordinates& reference,
                           Orl_orientation kind,
                           Virtual_direction direction)
{
  using namespace internal;
  Embedded_trees result;
  std::vector<Embedding> all(trees.size());
  result.reference = reference;
  constexpr int number_of_passes = 2;
  for (int pass = 0; pass < number_of_passes; ++pass) {
    const Embedding middle = as_embedding(layout, result.reference);
    pcs::internal::for_each_index<ConcurrencyTag>(
        trees.size(),
        [&](std::size_t t) {
          const Vec3 shift = trees[t]->origin - trees[0]->origin;
          all[t] = embed(layout, branches, *trees[t], paths[t], t, shift);
          if (kind == Orl_orientation::world_axes)
            set_world_frames(layout, all[t]);
          else if (kind == Orl_orientation::transported)
            set_frames(layout, Quaternion::Identity(), all[t]);
          else
            turn_frames(layout, middle, Quaternion::Identity(), all[t]);
          set_own_orientations(layout, kind, all[t]);
        },
        1);
    result.reference = middle_of_members<ConcurrencyTag>(layout, branches, all);
    if (kind != Orl_orientation::gauge_fixed)
      break;
  }
  for (std::size_t t = 0; t < trees.size(); ++t) {
    Orl_coordinates& x = all[t].x;
    for (std::size_t b = 0; b < branches.size(); ++b)
      if (!branches[b].has(t)) {
        x.attachment[b] = result.reference.attachment[b];
        const bool is_first = branches[branches[b].parent].has(t);
        const std::size_t first = layout.branches[b].first_edge;
        for (std::size_t j = 0; j < layout.branches[b].number_of_edges; ++j)
          x.orientation[first + j] =
              j == 0 && is_first && direction == Virtual_direction::along_parent
                  ? Quaternion::Identity()
                  : result.reference.orientation[first + j];
      }
    result.x.push_back(std::move(x));
  }
  return result;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_SHARED_TOPOLOGY_H
