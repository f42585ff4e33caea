// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The point map of a stand must store points.

#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <map>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Positions = std::map<int, double>;
#else
using Positions = std::map<int, Kernel::Point_3>;
#endif

void compile(const std::vector<int>& points,
             Positions& positions,
             std::map<int, std::size_t>& trees)
{
  pcs::segment_trees(points,
                     boost::make_assoc_property_map(trees),
                     pcs::parameters::point_map(boost::make_assoc_property_map(positions)));
}
