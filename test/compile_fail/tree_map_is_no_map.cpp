// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The tree indices of points are written to a property map, not to a container.

#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <cstddef>
#include <map>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

void compile(const std::vector<Kernel::Point_3>& points,
             std::map<Kernel::Point_3, std::size_t>& trees)
{
#ifdef PCS_BREAK_THE_RULE
  pcs::segment_trees(points, trees);
#else
  pcs::segment_trees(points, boost::make_assoc_property_map(trees));
#endif
}
