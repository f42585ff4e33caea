// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The largest angle of extrapolated edges must be a number.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = pcs::Orl_metric;
#else
using Option = double;
#endif

void compile(const Space& space, const Option& value)
{
  space.geodesic(0, 1, 0.5, pcs::parameters::max_extrapolation_angle(value));
}
