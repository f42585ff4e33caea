// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `do_use_unit_weights` must be a bool.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = pcs::Orl_metric;
#else
using Option = bool;
#endif

void compile(Space& space, const Option& value)
{
  space.build(pcs::parameters::do_use_unit_weights(value));
}
