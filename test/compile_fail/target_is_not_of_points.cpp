// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The target of a registration is a range of points.

#include <pcs/registration/fit_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Target_point = int;
#else
using Target_point = Point;
#endif

void compile(std::vector<Point>& points, const std::vector<Target_point>& target)
{
  pcs::fit_point_set(points, target);
}
