// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A graph of another type needs maps.

#include <pcs/Orl_shape_space.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>

#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Skeleton = pcs::Tree_skeleton<Kernel>;

#ifdef PCS_BREAK_THE_RULE
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;
#else
using Graph = Skeleton;
#endif

void compile(const Graph& graph)
{
  pcs::Orl_shape_space<Kernel> space;
  space.add_skeleton(graph);
}
