// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The map of matched points must store bool.

#include <pcs/registration/fit_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <map>
#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;

#ifdef PCS_BREAK_THE_RULE
using Value = Point;
#else
using Value = bool;
#endif

void compile(std::vector<Point>& points,
             const std::vector<Point>& target,
             std::map<Point, Value>& m)
{
  pcs::fit_point_set(points,
                     target,
                     pcs::parameters::point_is_matched_map(boost::make_assoc_property_map(m)));
}
