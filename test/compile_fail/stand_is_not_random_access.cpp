// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The points of a stand must be a random access range.

#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <list>
#include <map>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Points = std::list<Kernel::Point_3>;
#else
using Points = std::vector<Kernel::Point_3>;
#endif

void compile(const Points& points, std::map<Kernel::Point_3, std::size_t>& trees)
{
  pcs::segment_trees(points, boost::make_assoc_property_map(trees));
}
