// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Individual tree segmentation of a stand: positions, and the tree label of every point.

#ifndef PCS_SKELETON_FOREST_STAND_H
#define PCS_SKELETON_FOREST_STAND_H

#include <pcs/internal/progress.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/model/Scan.h>

#include <functional>
#include <vector>

namespace pcs {
namespace skeleton {

/// A tree, in input coordinates.
struct Detected_tree
{
  //! lower end of the axis of its thickest stem, moved to the ground if that is near
  Vec3 foot = Vec3::Zero();
  double radius = 0;           ///< largest radius in the lowest part of this stem [L]
  double radius_at_breast = 0; ///< its radius at breast height; 0 if it ends below [L]
  //! of the lower end of this axis above the ground below; 0 if that is not known [L]
  double above_ground = 0;
};

/// Returns the input points, the same at each call.
using Read_input = std::function<std::vector<Vec3>()>;

struct Stand
{
  std::vector<Detected_tree> trees;     ///< in descending order of radius
  std::vector<Index> tree_of_input;     ///< by input point; `none`: unassigned
  std::size_t number_of_low_plants = 0; ///< lower than breast height, and not among the trees
};

/*!
  Detects the trees of a scan. The points are finite, with at least two different ones. They are
  read several times, since they are not stored meanwhile. Returns `false` if the work was
  cancelled; in this case, `forest` remains unchanged. O(n log n).
*/
template <class ConcurrencyTag>
bool find_trees(const Read_input& read_input,
                const Session_hints& hints,
                pcs::internal::Progress& progress,
                Stand& forest);

} // namespace skeleton
} // namespace pcs

#ifndef PCS_COMPILED_SKELETON
#include <pcs/skeleton/forest/Stand_impl.h>
#endif

#endif // PCS_SKELETON_FOREST_STAND_H
