// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// State of a tree of a shape space: coordinates, geometry and buffers.

#ifndef PCS_SHAPE_SPACE_PATH_TREE_STATE_H
#define PCS_SHAPE_SPACE_PATH_TREE_STATE_H

#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/path/Extrapolation_limits.h>
#include <pcs/shape_space/path/Sequential_births.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

struct Tree_state
{
  Orl_coordinates x;
  Orl_geometry geometry;                ///< of `x`
  std::vector<std::size_t> first_point; ///< per edge, in the points of the tree; last: their number
  double lambda = 0;                    ///< parameter of the path through two trees [-]
  /// Weight of each scan in the points of more than two trees; empty: all equal [-].
  std::vector<double> scan_weights;

  // buffers that are reused when another tree is written here
  Extrapolation_buffers extrapolation;
  Sequential_births_buffers births;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PATH_TREE_STATE_H
