// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options of the construction of a space.

#ifndef PCS_SHAPE_SPACE_MODEL_BUILD_OPTIONS_H
#define PCS_SHAPE_SPACE_MODEL_BUILD_OPTIONS_H

#include <pcs/core/Orl_options.h>
#include <pcs/core/Orl_space_data.h>
#include <pcs/shape_space/model/Alignment_options.h>
#include <pcs/shape_space/model/Matched_branch.h>
#include <pcs/shape_space/model/Tree_family.h>

#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

/// Representation of trees in coordinates.
struct Representation_options
{
  Orl_orientation orientation = Orl_orientation::gauge_fixed;
  Virtual_direction direction = Virtual_direction::of_partner;
  bool has_unit_weights = false; ///< of the metric
};

struct Build_options
{
  Matching_weights weights;
  Alignment_options alignment;
  Representation_options form;
  Point_assignment_options assignment;
  Transport_options transport;
  std::size_t number_of_rounds = 3;
  std::size_t points_of = none; ///< tree whose scan gives the points of the branches that it has
};

struct Built_family
{
  Tree_family family;
  std::vector<Orl_space_data::Point> points;     ///< by edge
  std::vector<Orl_space_data::Partner> partners; ///< by point
  bool has_normals = false;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_BUILD_OPTIONS_H
