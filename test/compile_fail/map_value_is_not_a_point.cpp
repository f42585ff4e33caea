// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The point map must store points with three coordinates.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

#ifdef PCS_BREAK_THE_RULE
using Points = std::vector<CGAL::Simple_cartesian<double>::Point_2>;
#else
using Points = std::vector<CGAL::Simple_cartesian<double>::Point_3>;
#endif

void compile(Points& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points, handle, handle, pcs::Similarity());
}
