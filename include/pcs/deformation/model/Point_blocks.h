// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Layout of points in blocks of eight, one lane of a vector register per point; stored weights.

#ifndef PCS_DEFORMATION_MODEL_POINT_BLOCKS_H
#define PCS_DEFORMATION_MODEL_POINT_BLOCKS_H

#include <cstddef>

namespace pcs {
namespace deformation {

/// Number of points in a block [count].
constexpr std::size_t lanes = 8;

/// Coordinates of the points of a block: x of all, y of all, z of all.
struct Lane_vectors
{
  double value[3][lanes];
};

/// The weights of samples are stored in 16 bits, in steps of one over this.
constexpr double weight_steps = 65535;

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_MODEL_POINT_BLOCKS_H
