// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Frames across folds of an axis, where edges reverse their direction.

#ifndef PCS_SHAPE_SPACE_EMBEDDING_SKIP_FOLD_EDGES_H
#define PCS_SHAPE_SPACE_EMBEDDING_SKIP_FOLD_EDGES_H

#include <pcs/shape_space/model/Orl_coordinates.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

/// Marks the folds of a branch with the edges [`first`, `last`). A fold consists of the edges
/// between two bends by more than a right angle, where the second bend reverses the first.
/// Skeletons have folds where two pieces overlap.
inline void mark_folds(const std::vector<Vec3>& direction,
                       std::size_t first,
                       std::size_t last,
                       std::vector<char>& is_fold)
{
  std::size_t before = none; // the last edge before an open fold
  for (std::size_t e = first + 1; e < last; ++e) {
    if (!(direction[e - 1].dot(direction[e]) < 0))
      continue;
    if (before != none && direction[before].dot(direction[e]) > 0) {
      for (std::size_t k = before + 1; k < e; ++k)
        is_fold[k] = 1;
      before = none;
    } else
      before = e - 1;
  }
}

} // namespace internal

/*!
  Transports the frames of edges and branches beyond a fold from the last edge before the fold.
  `directions`: of the edges, for each tree; null for edges that the tree lacks.

  A fold of only one tree consists of two rotations by about pi, about axes that depend on noise or
  rounding. On the path between the trees, their interpolated product may be any rotation, so
  everything beyond a fold of a millimetre would have an arbitrary direction.
*/
inline void skip_fold_edges(const std::vector<std::vector<Vec3>>& directions, Orl_layout& layout)
{
  std::vector<char> is_fold(layout.number_of_edges(), 0);
  for (const std::vector<Vec3>& direction : directions)
    for (const Orl_layout::Branch& b : layout.branches)
      internal::mark_folds(direction, b.first_edge, b.first_edge + b.number_of_edges, is_fold);
  for (Orl_layout::Branch& b : layout.branches) {
    if (b.parent != none) // the first edge of a branch is not a fold
      while (is_fold[b.reference_edge])
        --b.reference_edge;
    layout.edge_before[b.first_edge] = b.reference_edge;
    std::size_t before = b.first_edge;
    for (std::size_t e = b.first_edge + 1; e < b.first_edge + b.number_of_edges; ++e)
      if (!is_fold[e]) {
        layout.edge_before[e] = before;
        before = e;
      }
  }
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_EMBEDDING_SKIP_FOLD_EDGES_H
