// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points that are modified in place cannot be constant.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Points = const std::vector<Point>;
#else
using Points = std::vector<Point>;
#endif

void compile(Points& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points, handle, handle, pcs::Similarity());
}
