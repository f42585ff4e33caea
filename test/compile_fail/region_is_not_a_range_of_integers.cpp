// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A region of interest is a range of point indices.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Region = std::vector<double>;
#else
using Region = std::vector<int>;
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle, const Region& region)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::region_of_interest(region));
}
