// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Counts are integers.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
constexpr double number_of_samples = 1e3;
#else
constexpr int number_of_samples = 1000;
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::number_of_samples(number_of_samples));
}
