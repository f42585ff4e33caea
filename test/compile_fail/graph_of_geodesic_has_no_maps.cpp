// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A graph of the caller needs maps of positions and radii.

#include <pcs/Orl_shape_space.h>

#include <boost/graph/adjacency_list.hpp>

using Space = pcs::Orl_shape_space<>;

struct Place
{
  Space::Point_3 point;
  double radius = 0;
};
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, Place>;

void compile(const Space& space, const pcs::Orl_tree& tree, Graph& result)
{
  const auto radii = pcs::parameters::node_radius_map(get(&Place::radius, result));
#ifdef PCS_BREAK_THE_RULE
  space.skeleton(tree, result, radii);
#else
  space.skeleton(tree, result, radii.node_point_map(get(&Place::point, result)));
#endif
}
