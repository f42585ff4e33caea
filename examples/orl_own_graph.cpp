// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees in a user-defined graph type, with positions and radii in vectors.

#include <pcs/orl_geodesic.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>

#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;

struct My_tree
{
  Graph graph;
  std::vector<Kernel::Point_3> places;
  std::vector<float> thickness;
};

/// Makes a trunk with one branch that begins at half height and points to the side `x`.
My_tree make_tree(double x)
{
  My_tree tree;
  tree.places = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {x, 0, 1.5}};
  tree.thickness = {0.2f, 0.15f, 0.1f, 0.1f};
  add_edge(0, 1, tree.graph); // from parent to child
  add_edge(1, 2, tree.graph);
  add_edge(1, 3, tree.graph);
  return tree;
}

int main()
{
  const My_tree one = make_tree(0.5), two = make_tree(0.9);
  //! [maps]
  const auto maps = [](const My_tree& tree) {
    return pcs::parameters::node_point_map(
               boost::make_iterator_property_map(tree.places.begin(),
                                                 get(boost::vertex_index, tree.graph)))
        .node_radius_map(boost::make_iterator_property_map(tree.thickness.begin(),
                                                           get(boost::vertex_index, tree.graph)));
  };
  const std::vector<Kernel::Point_3> no_scan;
  std::vector<Kernel::Point_3> no_points;
  pcs::Tree_skeleton<Kernel> middle;
  pcs::orl_geodesic(one.graph,
                    no_scan,
                    two.graph,
                    no_scan,
                    0.5,
                    middle,
                    no_points,
                    pcs::parameters::default_values(),
                    maps(one),
                    maps(two));
  //! [maps]
  const auto& branches = middle[boost::graph_bundle].branches;
  std::cout << branches.size() << " branches\n";
  return branches.size() == 2 ? EXIT_SUCCESS : EXIT_FAILURE;
}
