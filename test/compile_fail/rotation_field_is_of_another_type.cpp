// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The named parameter `rotation_field` is a value of an enumeration.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
constexpr int rotation_field = 3;
#else
constexpr auto rotation_field = pcs::Rotation_field::geodesic;
#endif

void compile(std::vector<Point>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::rotation_field(rotation_field));
}
