// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Wood of the stem below the crown, by the number of points that it supports.

#ifndef PCS_SKELETON_LEAVES_FIND_STEM_WOOD_H
#define PCS_SKELETON_LEAVES_FIND_STEM_WOOD_H

#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for the wood of the stem.
struct Stem_wood_options
{
  double fraction = 0.8;   ///< least fraction of all points in the subtree of a component [-]
  double likelihood = 2.0; ///< least log-odds of wood for a point [-]
};

/*!
  Marks the wood of the stem. A point of the level-set component `v` is marked if
  `n_v >= fraction n` and `wood_score >= likelihood`. `n_v` is the number of points of `v` and of
  its descendants, `n` that of all points in the tree of components [count]. Only the stem supports
  this fraction, even if its axis is fitted badly. Sums over the whole scan depend little on single
  points. O(points).
*/
inline std::vector<std::uint8_t> points_of_stem(const Layer_tree& layers,
                                                const std::vector<float>& wood_score,
                                                const Stem_wood_options& rules)
{
  std::vector<std::size_t> supported(layers.size());
  for (std::size_t v = layers.size(); v-- > 0;) { // children come after their parents
    supported[v] += layers.count(static_cast<Index>(v));
    if (layers.parent[v] != none)
      supported[layers.parent[v]] += supported[v];
  }
  const double least = rules.fraction * double(layers.point.size());
  std::vector<std::uint8_t> is_stem(wood_score.size(), 0);
  for (std::size_t i = 0; i < is_stem.size(); ++i) {
    const Index v = layers.node_of_point[i];
    is_stem[i] =
        v != none && double(supported[v]) >= least && double(wood_score[i]) >= rules.likelihood;
  }
  return is_stem;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_FIND_STEM_WOOD_H
