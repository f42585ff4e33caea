// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `mode_inner_product` is a value of an enumeration.

#include <pcs/find_modes.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Mode_inner_product;
#endif

void compile(const Space& space, const Option& value)
{
  pcs::find_modes(space, 2, pcs::parameters::mode_inner_product(value));
}
