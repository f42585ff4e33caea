// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `is_monotone` must be a bool.

#include <pcs/fit_growth_path.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = pcs::Orl_metric;
#else
using Option = bool;
#endif

void compile(const Space& space, const Option& value)
{
  pcs::fit_growth_path(space, {0, 1}, {0, 1}, pcs::parameters::is_monotone(value));
}
