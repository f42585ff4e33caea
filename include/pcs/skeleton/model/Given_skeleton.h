// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A skeleton given by the caller, as arrays.

#ifndef PCS_SKELETON_MODEL_GIVEN_SKELETON_H
#define PCS_SKELETON_MODEL_GIVEN_SKELETON_H

#include <pcs/skeleton/model/Scan.h>

#include <vector>

namespace pcs {
namespace skeleton {

/// A rooted tree of positions; parents come before their children.
struct Given_skeleton
{
  std::vector<Vec3> points;  ///< in the coordinates of the input
  std::vector<Index> parent; ///< `none`: the root
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_GIVEN_SKELETON_H
