// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The target of the moved points is a Similarity or an Aff_transformation_3.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
constexpr double target = 3;
#else
const pcs::Similarity target;
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points, handle, handle, target);
}
