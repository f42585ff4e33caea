// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The seed of a generator must be an integer.

#include <pcs/generators/grow_tree.h>

#include <CGAL/Simple_cartesian.h>

int main()
{
#ifdef PCS_BREAK_THE_RULE
  const double seed = 1.5;
#else
  const int seed = 1;
#endif
  pcs::Tree_skeleton<CGAL::Simple_cartesian<double>> tree;
  pcs::grow_tree(tree, pcs::fruit_habit(), pcs::parameters::random_seed(seed));
}
