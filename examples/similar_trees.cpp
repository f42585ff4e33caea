// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the growth parameters of three trees, grows a forest of similar ones, and tells a tree of
// another kind from them.

#include <pcs/generators/fit_tree_habit.h>
#include <pcs/generators/grow_forest.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/score_tree.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

int main()
{
  std::vector<Tree> trees(3); // in practice, skeletons of scans
  for (std::size_t i = 0; i < trees.size(); ++i)
    pcs::grow_tree(trees[i], pcs::fruit_habit(), pcs::parameters::random_seed(i));

  //! [fit]
  const pcs::Tree_habit_fit fit =
      pcs::fit_tree_habit(trees, pcs::parameters::number_of_simulations(30));
  for (const pcs::Habit_value& v : fit.values)
    if (v.is_identified)
      std::cout << v.name << " = " << v.value << " in [" << v.least << ", " << v.largest << "]\n";
  //! [fit]

  //! [forest]
  pcs::Forest_options options;
  options.number_of_trees = 20;
  options.age = {0.6, 1};
  const auto forest = pcs::grow_forest<Kernel>(fit, options);
  //! [forest]

  //! [score]
  Tree other;
  pcs::grow_tree(other, pcs::weeping_habit().scaled(0.45));
  const pcs::Tree_score similar = pcs::score_tree(trees[0], fit);
  const pcs::Tree_score outlier = pcs::score_tree(other, fit);
  std::cout << "distances " << similar.distance << " and " << outlier.distance << ", shares "
            << similar.share << " and " << outlier.share << "; the second tree deviates most in "
            << outlier.deviations.front().name << '\n';
  //! [score]
  return forest.size() == 20 && outlier.share < 0.02 && similar.share > outlier.share
             ? EXIT_SUCCESS
             : EXIT_FAILURE;
}
