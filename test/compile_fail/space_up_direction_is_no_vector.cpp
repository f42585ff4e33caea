// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The vertical direction must be a vector.

#include <pcs/Orl_shape_space.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = CGAL::Simple_cartesian<double>::Vector_3;
#endif

void compile(Space& space, const Option& value)
{
  space.build(pcs::parameters::up_direction(value));
}
