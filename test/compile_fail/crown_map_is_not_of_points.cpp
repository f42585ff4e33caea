// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The point map of a crown must store points.

#include <pcs/crowns/measure_crown.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <map>
#include <vector>

#ifdef PCS_BREAK_THE_RULE
using Positions = std::map<int, double>;
#else
using Positions = std::map<int, CGAL::Simple_cartesian<double>::Point_3>;
#endif

double compile(const std::vector<int>& points, const Positions& positions)
{
  const auto map = boost::make_assoc_property_map(positions);
  return pcs::crowns::measure_crown(points, 0.0, 0.5, pcs::parameters::point_map(map)).area;
}
