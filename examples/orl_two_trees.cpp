// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Two trees, the geodesic between them, and their distance.

#include <pcs/Orl_shape_space.h>
#include <pcs/generators/grow_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

/// Makes a ring of points around every node, as a minimal scan.
std::vector<Kernel::Point_3> rings(const pcs::Tree_skeleton<Kernel>& tree)
{
  std::vector<Kernel::Point_3> points;
  for (std::size_t v = 0; v < num_vertices(tree); ++v)
    for (int k = 0; k < 8; ++k)
      points.push_back(tree[v].point + tree[v].radius * Kernel::Vector_3(std::cos(k * CGAL_PI / 4),
                                                                         std::sin(k * CGAL_PI / 4),
                                                                         0));
  return points;
}

int main()
{
  pcs::Tree_skeleton<Kernel> young, old;
  pcs::grow_tree(young, pcs::broadleaf_habit().scaled(0.5), pcs::parameters::random_seed(1));
  pcs::grow_tree(old, pcs::broadleaf_habit(), pcs::parameters::random_seed(2));

  //! [space]
  pcs::Orl_shape_space<Kernel> space;
  const auto a = space.add(young, rings(young));
  const auto b = space.add(old, rings(old));
  std::cout << space.build() << '\n';

  pcs::Tree_skeleton<Kernel> skeleton;
  std::vector<Kernel::Point_3> points;
  pcs::Orl_tree tree; // its memory, and that of the points, is reused
  for (const double lambda : {0.25, 0.5, 0.75, 1.25}) {
    space.geodesic(a, b, lambda, tree);
    space.skeleton(tree, skeleton);
    space.points(tree, points);
    std::cout << "at " << lambda << ": " << num_vertices(skeleton) << " nodes, " << points.size()
              << " points\n";
  }
  //! [space]

  //! [distance]
  const pcs::Orl_tree middle = space.geodesic(a, b, 0.5);
  const double whole = space.distance(a, b);
  const double half = space.distance(space.tree(a), middle);
  std::cout << "distance " << whole << ", to the middle " << half << '\n';
  //! [distance]
  return std::abs(half - whole / 2) < 1e-9 * whole ? EXIT_SUCCESS : EXIT_FAILURE;
}
