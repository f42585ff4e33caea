// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The point map of a stand must accept the elements of the range.

#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Element = std::pair<Point, int>;

#ifdef PCS_BREAK_THE_RULE
using Key = std::pair<Point, Point>;
#else
using Key = Element;
#endif

void compile(const std::vector<Element>& points, std::map<Element, std::size_t>& trees)
{
  pcs::segment_trees(points,
                     boost::make_assoc_property_map(trees),
                     pcs::parameters::point_map(CGAL::First_of_pair_property_map<Key>()));
}
