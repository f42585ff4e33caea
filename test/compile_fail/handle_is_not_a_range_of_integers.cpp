// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A handle is a range of point indices.

#include <pcs/Point_set_deformation.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Handle = std::vector<Point>;
#else
using Handle = std::vector<int>;
#endif

void compile(std::vector<Point>& points, const Handle& handle)
{
  pcs::Point_set_deformation session(points);
  session.add_handle(handle);
}
