// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Integers cannot hold the coordinates of deformed points.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

#ifdef PCS_BREAK_THE_RULE
using Kernel = CGAL::Simple_cartesian<int>;
#else
using Kernel = CGAL::Simple_cartesian<float>;
#endif

void compile(std::vector<Kernel::Point_3>& points,
             const std::vector<pcs::Deformation_handle>& handles)
{
  pcs::deform_point_set(points, handles);
}
