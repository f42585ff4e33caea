// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A named parameter of CGAL with the name of one of pcs is an error, not ignored.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

void compile(std::vector<Kernel::Point_3>& points,
             const std::vector<pcs::Deformation_handle>& handles)
{
#ifdef PCS_BREAK_THE_RULE
  pcs::deform_point_set(points, handles, CGAL::parameters::number_of_samples(50));
#else
  pcs::deform_point_set(points, handles, pcs::parameters::number_of_samples(50));
#endif
}
