// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The named parameter `landmarks` is a vector of landmarks.

#include <pcs/registration/fit_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
const std::vector<int> landmarks;
#else
const std::vector<pcs::Landmark> landmarks;
#endif

void compile(std::vector<Point>& points, const std::vector<Point>& target)
{
  pcs::fit_point_set(points,
                     target,
                     pcs::parameters::default_values(),
                     pcs::parameters::landmarks(landmarks));
}
