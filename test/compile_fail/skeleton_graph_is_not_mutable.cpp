// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The graph of a skeleton must allow adding vertices and edges.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Graph = std::vector<int>;
#else
using Graph = pcs::Tree_skeleton<Kernel>;
#endif

void compile(const std::vector<Kernel::Point_3>& points, Graph& tree)
{
  pcs::extract_tree_skeleton(points, tree);
}
