// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Runs a skeletonization stage by stage, inspects the intermediate results, and makes a mesh.

#include <pcs/IO/write_mesh.h>
#include <pcs/Tree_skeletonization.h>
#include <pcs/generators/scan_tree.h>
#include <pcs/generators/tree_fixtures.h>
#include <pcs/make_branch_surface.h>

#include <CGAL/Simple_cartesian.h>

#include <array>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  pcs::Virtual_scan<Kernel> scan;
  pcs::scan_tree(pcs::make_fork_tree<Kernel>(2, 0.05, 0.03, 0.8), scan);

  //! [stages]
  pcs::Tree_skeletonization stages(scan.points,
                                   pcs::parameters::up_direction(Kernel::Vector_3(0, 0, 1)));
  stages.find_neighbors();
  std::cout << "spacing " << 1000 * stages.report().spacing << " mm\n";
  stages.find_paths();
  std::cout << stages.layers().size() << " level-set components\n";
  stages.fit_axes();
  std::cout << stages.axes().axes.size() << " axes\n";

  pcs::Tree_skeleton<Kernel> tree;
  const auto report = stages.extract(tree);
  std::cout << report.number_of_branches << " branches\n";
  //! [stages]

  //! [surface]
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
  const auto surface =
      pcs::make_branch_surface(tree, points, triangles, pcs::parameters::tolerance(0.001));
  pcs::IO::write_mesh("skeleton_stages.ply", points, triangles);
  //! [surface]
  std::cout << surface.number_of_triangles << " triangles\n";
  return report.number_of_branches >= 2 && surface.number_of_triangles > 0 ? 0 : 1;
}
