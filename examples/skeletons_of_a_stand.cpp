// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Segments a cloud of three trees, and extracts the skeleton of each.

#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/segment_trees.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <cstddef>
#include <iostream>
#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Labelled_point = std::pair<Kernel::Point_3, std::size_t>; // point and index of its tree
using Point_map = CGAL::First_of_pair_property_map<Labelled_point>;
using Tree_map = CGAL::Second_of_pair_property_map<Labelled_point>;

int main()
{
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.1 * CGAL_PI / 180;
  std::vector<Labelled_point> stand;
  for (int k = 0; k < 3; ++k) {
    pcs::Tree_skeleton<Kernel> truth;
    pcs::grow_tree(truth, pcs::fruit_habit(), pcs::parameters::random_seed(k));
    pcs::Virtual_scan<Kernel> scan;
    pcs::scan_tree(truth, scan, scanner, pcs::parameters::random_seed(k));
    for (const Kernel::Point_3& p : scan.points)
      stand.emplace_back(p + Kernel::Vector_3(1.5 * k, 0, 0), 0);
  }

  //! [segment]
  const auto trees =
      pcs::segment_trees(stand, Tree_map(), pcs::parameters::point_map(Point_map())).trees;
  for (std::size_t t = 0; t < trees.size(); ++t) {
    std::vector<Kernel::Point_3> points;
    for (const auto& [point, tree] : stand)
      if (tree == t) // pcs::npos: not part of a tree
        points.push_back(point);
    pcs::Tree_skeleton<Kernel> skeleton;
    const auto report = pcs::extract_tree_skeleton(points, skeleton);
    std::cout << "at " << trees[t].foot[0] << ", " << trees[t].foot[1] << ": " << report.height
              << " m high, " << report.total.length << " m of branches\n";
  }
  //! [segment]
  return trees.size() == 3 ? 0 : 1;
}
