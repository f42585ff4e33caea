// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A family of trees: mean, modes of variation and random trees, with points in the same order.

#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/find_modes.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/mean_tree.h>
#include <pcs/sample_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

int main()
{
  //! [family]
  pcs::Orl_shape_space<Kernel> space;
  for (int i = 0; i < 5; ++i) {
    pcs::Tree_habit habit = pcs::fruit_habit();
    habit.number_of_orders = 2;
    habit.height *= 0.8 + 0.1 * i;
    Tree tree;
    pcs::grow_tree(tree, habit, pcs::parameters::random_seed(3));
    std::vector<Kernel::Point_3> scan;
    for (std::size_t v = 0; v < num_vertices(tree); ++v)
      scan.push_back(tree[v].point + Kernel::Vector_3(tree[v].radius, 0, 0));
    space.add(tree, scan);
  }
  std::cout << space.build() << '\n';
  const pcs::Orl_tree mean = pcs::mean_tree(space);
  std::cout << "the mean is " << pcs::measure_shape(space, mean).height << " m high\n";
  //! [family]

  //! [modes]
  const auto modes = pcs::find_modes(space, 2);
  std::cout << "the first mode has " << 100 * modes.share(1) << " % of the variance\n";
  for (std::size_t h = 0; h < space.number_of_trees(); ++h)
    std::cout << "tree " << h << ": score " << modes.scores(static_cast<Eigen::Index>(h), 0)
              << '\n';
  const pcs::Orl_tree extreme = pcs::tree_of_modes(space, modes, {2}); // two standard deviations
  //! [modes]

  //! [samples]
  const auto distribution = pcs::learn_distribution(space);
  std::vector<Kernel::Point_3> points; // its memory is reused
  double shortest = pcs::measure_shape(space, extreme).height;
  for (std::uint64_t i = 0; i < 3; ++i) {
    const pcs::Orl_tree tree = pcs::sample_tree(space, distribution, 42, i);
    space.points(tree, points);
    std::cout << "random tree " << i << ": " << pcs::measure_shape(space, tree).height
              << " m high, " << points.size() << " points\n";
    shortest = std::min(shortest, pcs::measure_shape(space, tree).height);
  }
  //! [samples]
  return shortest > 0 && !points.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}
