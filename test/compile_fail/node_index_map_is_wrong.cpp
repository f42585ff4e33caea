// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Vertices are numbered by integers.

#include <pcs/Orl_shape_space.h>

#include <boost/property_map/function_property_map.hpp>

#include <cstddef>

using Space = pcs::Orl_shape_space<>;
using Skeleton = pcs::Tree_skeleton<CGAL::Simple_cartesian<double>>;

#ifdef PCS_BREAK_THE_RULE
using Option = double;
#else
using Option = std::size_t;
#endif

using Vertex = boost::graph_traits<Skeleton>::vertex_descriptor;
using Index_map = boost::function_property_map<Option (*)(Vertex), Vertex, Option>;

void compile(Space& space, const Skeleton& tree, const Index_map& numbers)
{
  space.add_skeleton(tree, pcs::parameters::node_index_map(numbers));
}
