// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// State of a shape space: the added trees, and the result of construction or restoration.

#ifndef PCS_SHAPE_SPACE_SPACE_STATE_H
#define PCS_SHAPE_SPACE_SPACE_STATE_H

#include <pcs/core/Orl_space_data.h>
#include <pcs/shape_space/family/Family_points.h>
#include <pcs/shape_space/input/tree_input.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/pair/Embedded_pair.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// State of a shape space. A cancelled construction does not change it; adding a tree discards all
/// but `inputs`.
struct Space_state
{
  std::vector<Tree_input> inputs; ///< as added; of a restored pair, only the scans

  // valid if `is_built`
  Tree_family family;
  Embedded_pair pair;                               ///< of two trees: topology and pairs of points
  Family_points family_points;                      ///< of more than two trees
  std::vector<Orl_space_data::Point> stored_points; ///< points of `family_points` as numbers
  std::vector<Orl_space_data::Partner> stored_partners;
  bool is_built = false;
  bool is_restored = false; ///< from a file: no tree can be added

  bool is_pair() const { return family.x.size() == 2; }
  bool has_normals() const
  {
    return is_pair() ? pair.instances.has_normals() : family_points.has_normals();
  }
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_SPACE_STATE_H
