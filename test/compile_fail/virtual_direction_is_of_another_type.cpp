// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `virtual_direction` of a shape space has its own type.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Virtual_direction;
#endif

void compile(Space& space, const Option& value)
{
  space.build(pcs::parameters::virtual_direction(value));
}
