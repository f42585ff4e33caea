// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One tree at three dates: a smooth growth path, and a table of changes.

#include <pcs/Orl_shape_space.h>
#include <pcs/compare_trees.h>
#include <pcs/fit_growth_path.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/tree_at_age.h>

#include <CGAL/Simple_cartesian.h>

#include <cstdlib>
#include <iostream>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

int main()
{
  pcs::Tree_habit habit = pcs::fruit_habit();
  habit.number_of_orders = 2;
  Tree old_tree;
  pcs::grow_tree(old_tree, habit, pcs::parameters::random_seed(7));
  const double ages[] = {0.4, 0.7, 1};

  //! [growth]
  pcs::Orl_shape_space<Kernel> space;
  for (const double age : ages)
    space.add_skeleton(pcs::tree_at_age(old_tree, age));
  space.build();
  const auto path =
      pcs::fit_growth_path(space, {0, 1, 2}, {0.4, 0.7, 1}, pcs::parameters::is_monotone(true));
  double last = 0;
  bool is_growing = true;
  for (int k = 4; k <= 10; ++k) {
    const double length = pcs::measure_shape(space, pcs::tree_at_time(space, path, 0.1 * k)).length;
    std::cout << "at " << 0.1 * k << ": " << length << " m of branches\n";
    is_growing = is_growing && length >= last;
    last = length;
  }
  //! [growth]

  //! [changes]
  int number_new = 0, number_longer = 0;
  for (const auto& change : pcs::find_branch_changes(space, 0, 2)) {
    number_new += change.is_new;
    number_longer += change.is_longer;
  }
  std::cout << number_new << " branches are new, " << number_longer << " have become longer\n";
  //! [changes]
  return is_growing && number_longer > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
