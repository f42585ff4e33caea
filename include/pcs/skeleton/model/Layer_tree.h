// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tree of geodesic level-set components.

#ifndef PCS_SKELETON_MODEL_LAYER_TREE_H
#define PCS_SKELETON_MODEL_LAYER_TREE_H

#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Thickness of a level set in spacings [-].
constexpr double layer_thickness = 3;

/// Tree whose nodes are level-set components. Parents have smaller indices than their children.
struct Layer_tree
{
  std::vector<Index> node_of_point; ///< `none` for unreached points
  std::vector<Index> parent;        ///< `none` at the sources
  std::vector<Vec3> center;         ///< mean of the points of a node
  std::vector<double> spread;       ///< root mean square distance of the points from it [L]
  //! child that continues a thick ring; the node itself: the ring ends here; `none`: no ring
  std::vector<Index> next_in_ring;
  std::vector<Index> first; ///< offsets into `point`
  std::vector<Index> point; ///< points, ordered by node

  std::size_t size() const { return parent.size(); }
  std::size_t count(Index node) const { return first[node + 1] - first[node]; }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_LAYER_TREE_H
