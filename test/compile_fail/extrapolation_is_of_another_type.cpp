// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `extrapolation` is a value of an enumeration.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Orl_extrapolation;
#endif

void compile(const Space& space, const Option& value)
{
  space.geodesic(0, 1, 0.5, pcs::parameters::extrapolation(value));
}
