// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Where branches point that a tree does not have.

#ifndef PCS_SHAPE_SPACE_VIRTUAL_DIRECTION_H
#define PCS_SHAPE_SPACE_VIRTUAL_DIRECTION_H

namespace pcs {
namespace shape_space {

/// Where a branch without partner points in the tree that does not have it.
enum class Virtual_direction {
  of_partner,  ///< as in the other tree: it grows in its direction
  along_parent ///< along its parent: it grows upwards, then bends, as in the text
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_VIRTUAL_DIRECTION_H
