// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree on a topology: lengths, directions and frames of its edges.

#ifndef PCS_SHAPE_SPACE_EMBEDDING_EMBEDDING_H
#define PCS_SHAPE_SPACE_EMBEDDING_EMBEDDING_H

#include <pcs/core/rotations.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

/// Lengths, radii, attachments and directions of a tree; empty for branches that it lacks.
struct Embedding
{
  std::vector<Vec3> direction;   ///< per edge; null for edges that do not exist
  std::vector<Quaternion> frame; ///< per edge
  Orl_coordinates x;
};

/// Returns a tree without branches.
inline Embedding empty_embedding(const Orl_layout& layout, const Vec3& root)
{
  const std::size_t n = layout.number_of_edges(), m = layout.branches.size();
  Embedding result;
  result.direction.assign(n, Vec3::Zero());
  result.frame.assign(n, Quaternion::Identity());
  Orl_coordinates& x = result.x;
  x.root = root;
  x.orientation.assign(n, Quaternion::Identity());
  x.length.assign(n, 0);
  x.radius.assign(n, 0);
  x.base_radius.assign(m, 0);
  x.attachment.assign(m, 0);
  return result;
}

/// Computes length and direction of an edge. An edge between coincident nodes has no direction, see
/// `lend_directions()`: the path returns to a point, or a node of the other tree is near its own.
inline void set_edge(const Vec3& difference, double shortest, double& length, Vec3& direction)
{
  const double norm = difference.norm();
  length = std::max(norm, shortest);
  direction = norm > shortest ? Vec3(difference / norm) : Vec3(Vec3::Zero());
}

/// Sets missing directions of edges to the direction of the previous edge of the branch, or else of
/// the first edge that has a direction.
inline void lend_directions(const Orl_layout::Branch& branch, std::vector<Vec3>& direction)
{
  const auto begin = direction.begin() + static_cast<std::ptrdiff_t>(branch.first_edge);
  const auto end = begin + static_cast<std::ptrdiff_t>(branch.number_of_edges);
  const auto known = std::find_if(begin, end, [](const Vec3& d) { return d != Vec3::Zero(); });
  Vec3 last = known != end ? *known : Vec3(Vec3::UnitZ());
  for (auto d = begin; d != end; ++d)
    last = *d = *d != Vec3::Zero() ? *d : last;
}

/// Transports frames along the existing edges without twist, from `root` at the beginning of the
/// trunk.
inline void set_frames(const Orl_layout& layout, const Quaternion& root, Embedding& tree)
{
  for (std::size_t e = 0; e < layout.number_of_edges(); ++e)
    if (tree.x.length[e] > 0) {
      const std::size_t p = layout.edge_before[e];
      const Quaternion parent = p == none ? root : tree.frame[p];
      const Quaternion step = shortest_turn(Vec3::UnitZ(), parent.conjugate() * tree.direction[e]);
      tree.frame[e] = parent * step;
      tree.frame[e].normalize();
    }
}

} // namespace internal
} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_EMBEDDING_H
