// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The joint of an axis with its parent.

#ifndef PCS_SKELETON_MODEL_JOINT_H
#define PCS_SKELETON_MODEL_JOINT_H

#include <pcs/skeleton/model/Axis.h>

#include <limits>

namespace pcs {
namespace skeleton {

/// Attachment of an axis to its parent.
struct Joint
{
  Index parent = none; ///< `none`: the root, or no parent within reach
  Axis_place place;
  bool is_reversed = false; ///< the tip of the axis is its base
  double cost = std::numeric_limits<double>::infinity();
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_JOINT_H
