// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The point map must be writable; the map of constant points is not.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <boost/property_map/property_map.hpp>

#include <utility>
#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Element = std::pair<Point, int>;

struct Read_map
{
  using key_type = Element;
  using value_type = Point;
  using reference = const Point&;
  using category = boost::readable_property_map_tag;
  friend const Point& get(Read_map, const Element& e) { return e.first; }
};

#ifdef PCS_BREAK_THE_RULE
using Map = Read_map;
#else
using Map = CGAL::First_of_pair_property_map<Element>;
#endif

void compile(std::vector<Element>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::point_map(Map()));
}
