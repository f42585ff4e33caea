// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The number of resamples must be an integer.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Count = double;
#else
using Count = int;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             pcs::Tree_skeleton<Kernel>& tree,
             Count count)
{
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::number_of_resamples(count));
}
