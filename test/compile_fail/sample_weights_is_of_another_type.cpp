// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The named parameter `sample_weights` is a value of an enumeration.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
constexpr int sample_weights = 3;
#else
constexpr auto sample_weights = pcs::Sample_weights::compact;
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::sample_weights(sample_weights));
}
