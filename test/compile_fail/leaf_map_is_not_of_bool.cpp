// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The map of leaf points must store bool.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <map>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Value = Kernel::Point_3;
#else
using Value = bool;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             std::map<Kernel::Point_3, Value>& leaf,
             pcs::Tree_skeleton<Kernel>& tree)
{
  pcs::extract_tree_skeleton(
      points,
      tree,
      pcs::parameters::point_is_leaf_map(boost::make_assoc_property_map(leaf)));
}
