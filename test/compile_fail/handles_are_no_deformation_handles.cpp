// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Handles are a range of Deformation_handle.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Handles = std::vector<int>;
#else
using Handles = std::vector<pcs::Deformation_handle>;
#endif

void compile(std::vector<Point>& points, const Handles& handles)
{
  pcs::deform_point_set(points, handles);
}
