// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option to continue the trunk must be a bool.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Value = const char*;
#else
using Value = bool;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             const Value& value,
             pcs::Tree_skeleton<Kernel>& tree)
{
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::do_continue_trunk(value));
}
