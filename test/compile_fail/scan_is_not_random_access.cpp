// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A scan must be a random access range.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <list>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Points = std::list<Kernel::Point_3>;
#else
using Points = std::vector<Kernel::Point_3>;
#endif

void compile(const Points& points, pcs::Tree_skeleton<Kernel>& tree)
{
  pcs::extract_tree_skeleton(points, tree);
}
