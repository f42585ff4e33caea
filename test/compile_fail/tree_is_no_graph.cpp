// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree must be a graph.

#include <pcs/orl_geodesic.h>

#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Scan = std::vector<Kernel::Point_3>;

#ifdef PCS_BREAK_THE_RULE
using Tree = Scan;
#else
using Tree = pcs::Tree_skeleton<Kernel>;
#endif

void compile(const Tree& tree, const pcs::Tree_skeleton<Kernel>& other, Scan& scan)
{
  pcs::Tree_skeleton<Kernel> result;
  pcs::orl_geodesic(other, scan, tree, scan, 0.5, result, scan);
}
