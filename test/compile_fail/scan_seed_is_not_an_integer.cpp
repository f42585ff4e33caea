// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The seed of a virtual scan must be an integer.

#include <pcs/generators/scan_tree.h>

#include <CGAL/Simple_cartesian.h>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Value = double;
#else
using Value = int;
#endif

void compile(const pcs::Tree_skeleton<Kernel>& tree, Value seed, pcs::Virtual_scan<Kernel>& scan)
{
  pcs::scan_tree(tree, scan, pcs::Virtual_scanner(), pcs::parameters::random_seed(seed));
}
