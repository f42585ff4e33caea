// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The point map must accept elements of the point range as keys.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Element = std::pair<Point, int>;

#ifdef PCS_BREAK_THE_RULE
using Key = std::pair<Point, Point>;
#else
using Key = Element;
#endif

void compile(std::vector<Element>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::point_map(CGAL::First_of_pair_property_map<Key>()));
}
