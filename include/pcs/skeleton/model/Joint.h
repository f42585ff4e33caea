// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The joint of an axis with its parent.

#ifndef PCS_SKELETON_MODEL_JOINT_H
#define PCS_SKELETON_MODEL_JOINT_H

#include <pcs/skeleton/model/Axis.h>

#include <limits>

namespace pcs {
namespace skeleton {

/// Where an axis sits on its parent.
struct Joint
{
  Index parent = none; ///< `none`: the root, or out of reach
  Axis_place place;
  bool is_reversed = false; ///< its tip is the base
  double cost = std::numeric_limits<double>::infinity();
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_JOINT_H
