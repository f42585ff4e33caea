// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii must be numbers.

#include <pcs/Orl_shape_space.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>

#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Skeleton = pcs::Tree_skeleton<Kernel>;

using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;

#ifdef PCS_BREAK_THE_RULE
using Radius = std::string;
#else
using Radius = float;
#endif

void compile(const Graph& graph,
             const std::vector<Kernel::Point_3>& points,
             const std::vector<Radius>& radii)
{
  pcs::Orl_shape_space<Kernel> space;
  space.add_skeleton(
      graph,
      pcs::parameters::node_point_map(
          boost::make_iterator_property_map(points.begin(), get(boost::vertex_index, graph)))
          .node_radius_map(
              boost::make_iterator_property_map(radii.begin(), get(boost::vertex_index, graph))));
}
