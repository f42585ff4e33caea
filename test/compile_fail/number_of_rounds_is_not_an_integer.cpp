// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The number of matching rounds must be an integer.

#include <pcs/Orl_shape_space.h>

#include <CGAL/Simple_cartesian.h>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Count = double;
#else
using Count = int;
#endif

void compile(pcs::Orl_shape_space<Kernel>& space, Count rounds)
{
  space.build(pcs::parameters::number_of_rounds(rounds));
}
