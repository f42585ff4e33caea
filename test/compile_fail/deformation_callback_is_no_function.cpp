// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A callback of a deformation takes a fraction and returns whether to continue.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
constexpr int callback = 3;
#else
constexpr auto callback = [](double) { return true; };
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::callback(callback));
}
