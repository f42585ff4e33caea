// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The named parameter `do_preserve_volume` is a bool.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
const std::vector<int> do_preserve_volume;
#else
constexpr bool do_preserve_volume = false;
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::do_preserve_volume(do_preserve_volume));
}
