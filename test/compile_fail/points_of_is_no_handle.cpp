// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `points_of` must be the handle of an added tree.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = pcs::Orl_metric;
#else
using Option = Space::Handle;
#endif

void compile(Space& space, const Option& value)
{
  space.build(pcs::parameters::points_of(value));
}
