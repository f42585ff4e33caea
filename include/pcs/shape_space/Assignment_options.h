// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// How points are given to branches.

#ifndef PCS_SHAPE_SPACE_ASSIGNMENT_OPTIONS_H
#define PCS_SHAPE_SPACE_ASSIGNMENT_OPTIONS_H

#include <cstddef>

namespace pcs {
namespace shape_space {

struct Assignment_options
{
  double noise =
      0.1; ///< points lie off the surface by this share of the radius; the text's factor 1.1 [-]
  double normal_angle = 0.5; ///< deviation of normals that counts as much as the noise [rad]
  std::size_t number_of_neighbors = 12; ///< for normals, where none are given
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_ASSIGNMENT_OPTIONS_H
