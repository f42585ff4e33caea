// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The progress callback must be a function.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = bool (*)(double);
#endif

void compile(Space& space, const Option& value)
{
  space.build(pcs::parameters::callback(value));
}
