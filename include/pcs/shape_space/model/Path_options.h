// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Options for interpolation and extrapolation along geodesics.

#ifndef PCS_SHAPE_SPACE_MODEL_PATH_OPTIONS_H
#define PCS_SHAPE_SPACE_MODEL_PATH_OPTIONS_H

#include <pcs/core/Orl_options.h>

namespace pcs {
namespace shape_space {

struct Path_options
{
  double max_extrapolation_angle = 0; ///< largest rotation of an edge beyond the ends [rad]
  bool do_limit_radii = false;
  Orl_extrapolation extrapolation = Orl_extrapolation::bounded;
  Branch_emergence emergence = Branch_emergence::simultaneous;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MODEL_PATH_OPTIONS_H
