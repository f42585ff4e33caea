// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Only the points of the deformed object have vectors; other points must not have any.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
const auto make_parameters = [](const auto& map) { return pcs::parameters::vector_map(map); };
#else
const auto make_parameters = [](const auto& map) { return pcs::parameters::normal_map(map); };
#endif

using Vector = CGAL::Simple_cartesian<double>::Vector_3;
using Element = std::pair<Point, Vector>;
using Point_map = CGAL::First_of_pair_property_map<Element>;
using Vector_map = CGAL::Second_of_pair_property_map<Element>;

void compile(std::vector<Point>& points, std::vector<Element>& others)
{
  pcs::Point_set_deformation session(points);
  session.apply(others, make_parameters(Vector_map()).point_map(Point_map()));
}
