// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Extracts the skeleton of a virtual scan, and prints its forestry measures.

#include <pcs/IO/write_points.h>
#include <pcs/IO/write_swc.h>
#include <pcs/extract_tree_skeleton.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  pcs::Tree_skeleton<Kernel> truth;
  pcs::grow_tree(truth, pcs::fruit_habit());
  pcs::Virtual_scanner scanner;
  scanner.angular_step = 0.1 * CGAL_PI / 180;
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(truth, scan, scanner);

  //! [extract]
  const std::vector<Kernel::Point_3>& points = scan.points; // any random access range
  pcs::Tree_skeleton<Kernel> tree;
  const auto report = pcs::extract_tree_skeleton(points, tree);
  //! [extract]
  if (report.status != pcs::Status::converged)
    return 1;

  //! [use]
  std::size_t measured = 0;
  for (const auto v : boost::make_iterator_range(vertices(tree)))
    measured += tree[v].is_measured; // also: point, radius, radius_error, branch
  std::cout << report.number_of_branches << " branches, " << report.total.length << " m, "
            << 1000 * report.total.volume << " l; trunk " << 100 * report.diameter_at_breast_height
            << " cm thick; " << measured << " of " << num_vertices(tree) << " radii measured\n";
  pcs::IO::write_swc("skeleton_of_a_tree.swc", tree);
  //! [use]
  pcs::IO::write_points("virtual_tree.ply", scan.points);
  return report.number_of_branches > 1 && measured > 0 ? 0 : 1;
}
