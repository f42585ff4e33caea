// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The method of the skeleton must be a Skeleton_method.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Value = int;
#else
using Value = pcs::Skeleton_method;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             const Value& value,
             pcs::Tree_skeleton<Kernel>& tree)
{
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::skeleton_method(value));
}
