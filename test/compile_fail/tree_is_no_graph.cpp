// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree must be a graph.

#include <pcs/Orl_shape_space.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>

#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Skeleton = pcs::Tree_skeleton<Kernel>;

#ifdef PCS_BREAK_THE_RULE
using Graph = std::vector<Kernel::Point_3>;
#else
using Graph = Skeleton;
#endif

void compile(const Graph& graph)
{
  pcs::Orl_shape_space<Kernel> space;
  space.add_skeleton(graph);
}
