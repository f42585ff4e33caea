// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Scanner positions must be a range of points.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Positions = std::vector<double>;
#else
using Positions = std::vector<Kernel::Point_3>;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             const Positions& scanners,
             pcs::Tree_skeleton<Kernel>& tree)
{
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::scanner_positions(scanners));
}
