// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Grows a virtual tree, scans it from three stations, and compares the points with the ground
// truth.

#include <pcs/generators/grow_tree.h>
#include <pcs/generators/scan_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  //! [scan]
  pcs::Tree_skeleton<Kernel> tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(7));

  pcs::Virtual_scanner scanner;
  scanner.number_of_stations = 3;
  scanner.angular_step = 0.0015;
  pcs::Virtual_scan<Kernel> scan;
  const auto report = pcs::scan_tree(tree, scan, scanner, pcs::parameters::random_seed(7));
  std::cout << report << '\n';
  //! [scan]

  //! [truth]
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (scan.node[i] >= 0) { // on the surface of a branch
      const auto& node = tree[static_cast<std::size_t>(scan.node[i])];
      sum += std::sqrt(CGAL::squared_distance(scan.points[i], node.point)) / node.radius;
      ++n;
    }
  std::cout << "points are " << sum / static_cast<double>(n) << " radii from their nodes\n";
  //! [truth]
  return report.status == pcs::Status::converged && n > 10000 ? EXIT_SUCCESS : EXIT_FAILURE;
}
