// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A named parameter of another function is an error, not ignored.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

void compile(const std::vector<Kernel::Point_3>& points, pcs::Tree_skeleton<Kernel>& tree)
{
#ifdef PCS_BREAK_THE_RULE
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::tree_weights(std::vector<double>()));
#else
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::breast_height(1.3));
#endif
}
