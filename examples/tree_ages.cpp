// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A virtual tree at two ages and with edited branches; branch ids give the correspondences.

#include <pcs/core/Tree_measures.h>
#include <pcs/generators/edit_branches.h>
#include <pcs/generators/grow_tree.h>
#include <pcs/generators/tree_at_age.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <set>

using Kernel = CGAL::Simple_cartesian<double>;
using Tree = pcs::Tree_skeleton<Kernel>;

std::set<std::size_t> ids(const Tree& tree)
{
  std::set<std::size_t> result;
  for (const pcs::Tree_branch& branch : tree[boost::graph_bundle].branches)
    result.insert(branch.id);
  return result;
}

int main()
{
  //! [ages]
  Tree old_tree;
  pcs::grow_tree(old_tree, pcs::fruit_habit(), pcs::parameters::random_seed(7));
  const Tree young_tree = pcs::tree_at_age(old_tree, 0.7);
  for (const Tree& tree : {young_tree, old_tree})
    std::cout << ids(tree).size() << " branches, " << pcs::measure_tree(tree).length << " m, "
              << 1000 * pcs::measure_tree(tree).volume << " l\n";
  //! [ages]

  //! [edits]
  Tree edited = pcs::prune_branch(old_tree, 3);
  pcs::turn_branch(edited, 5, Kernel::Vector_3(0, 0, 1), 0.5); // yaw [rad]
  pcs::lengthen_branch(edited, 6, 1.3);
  //! [edits]
  const bool is_gone = ids(edited).count(3) == 0 && ids(edited).count(5) == 1;
  std::cout << ids(edited).size() << " branches are left after pruning\n";
  return is_gone && ids(young_tree).size() < ids(old_tree).size() ? EXIT_SUCCESS : EXIT_FAILURE;
}
