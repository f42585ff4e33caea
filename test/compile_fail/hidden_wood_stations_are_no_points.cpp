// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Hidden wood is inferred from positions of scanners, which must be points.

#include <pcs/generators/complete_hidden_wood.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Positions = std::vector<double>;
#else
using Positions = std::vector<Kernel::Point_3>;
#endif

void compile(const pcs::Tree_skeleton<Kernel>& tree,
             const std::vector<Kernel::Point_3>& points,
             const pcs::Tree_habit_fit& fit,
             const Positions& scanners)
{
  pcs::complete_hidden_wood(tree, points, fit, pcs::parameters::scanner_positions(scanners));
}
