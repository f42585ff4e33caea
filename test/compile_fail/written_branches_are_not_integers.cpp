// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The branches of a skeleton are written as integers.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>

#include <map>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Graph = boost::adjacency_list<>;
using Vertex = boost::graph_traits<Graph>::vertex_descriptor;

#ifdef PCS_BREAK_THE_RULE
using Value = double;
#else
using Value = int;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             std::map<Vertex, Kernel::Point_3>& positions,
             std::map<Vertex, double>& radii,
             std::map<Vertex, Value>& branches,
             Graph& tree)
{
  pcs::extract_tree_skeleton(
      points,
      tree,
      pcs::parameters::node_point_map(boost::make_assoc_property_map(positions))
          .node_radius_map(boost::make_assoc_property_map(radii))
          .node_branch_map(boost::make_assoc_property_map(branches)));
}
