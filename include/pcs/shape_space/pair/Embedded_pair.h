// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Two trees on their common topology, with corresponding points.

#ifndef PCS_SHAPE_SPACE_PAIR_EMBEDDED_PAIR_H
#define PCS_SHAPE_SPACE_PAIR_EMBEDDED_PAIR_H

#include <pcs/shape_space/model/Build_options.h>
#include <pcs/shape_space/model/Common_topology.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/points/Point_instances.h>

#include <array>
#include <vector>

namespace pcs {
namespace shape_space {

struct Embedded_pair
{
  Representation_options form;
  Quaternion rotation = Quaternion::Identity(); ///< aligns tree 2 with tree 1
  Common_topology topology;
  Orl_layout layout;
  std::array<Orl_coordinates, 2> x;
  std::array<Orl_geometry, 2> geometry;
  std::vector<char> is_relative;
  Orl_weights weights;
  Point_instances instances;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PAIR_EMBEDDED_PAIR_H
