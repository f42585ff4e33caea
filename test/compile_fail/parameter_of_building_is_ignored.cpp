// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A space with given correspondences does not read parameters of the search for them.

#include <pcs/Orl_shape_space.h>

#include <CGAL/Simple_cartesian.h>

using Kernel = CGAL::Simple_cartesian<double>;

void compile(pcs::Orl_shape_space<Kernel>& space, const pcs::Orl_correspondences& correspondences)
{
#ifdef PCS_BREAK_THE_RULE
  space.build_from(correspondences,
                   pcs::parameters::assignment_options(pcs::Point_assignment_options()));
#else
  space.build_from(correspondences, pcs::parameters::do_use_unit_weights(true));
#endif
}
