// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A habit is fitted to a range of skeletons.

#include <pcs/generators/fit_tree_habit.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

int main()
{
#ifdef PCS_BREAK_THE_RULE
  const std::vector<int> trees;
#else
  const std::vector<pcs::Tree_skeleton<CGAL::Simple_cartesian<double>>> trees;
#endif
  pcs::fit_tree_habit(trees);
}
