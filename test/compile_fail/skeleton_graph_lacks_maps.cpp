// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A skeleton of another graph type needs maps for positions and radii.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Graph = boost::adjacency_list<>;
#else
using Graph = pcs::Tree_skeleton<Kernel>;
#endif

void compile(const std::vector<Kernel::Point_3>& points, Graph& tree)
{
  pcs::extract_tree_skeleton(points, tree);
}
