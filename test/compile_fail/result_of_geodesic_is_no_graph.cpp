// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree is written to a graph with vertices and edges that can be added.

#include <pcs/Orl_shape_space.h>

#include <boost/graph/adjacency_list.hpp>

using Space = pcs::Orl_shape_space<>;

struct Place
{
  Space::Point_3 point;
  double radius = 0;
};
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, Place>;

#ifdef PCS_BREAK_THE_RULE
struct Result
{
};
#else
using Result = Graph;
#endif

void compile(const Space& space, const pcs::Orl_tree& tree, Result& result, Graph& graph)
{
  space.skeleton(tree,
                 result,
                 pcs::parameters::node_point_map(get(&Place::point, graph))
                     .node_radius_map(get(&Place::radius, graph)));
}
