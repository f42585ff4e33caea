// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option to join branches must be a bool.

#include <pcs/make_branch_surface.h>

#include <CGAL/Simple_cartesian.h>

#include <array>
#include <cstddef>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Value = double;
#else
using Value = bool;
#endif

void compile(const pcs::Tree_skeleton<Kernel>& tree,
             const Value& value,
             std::vector<Kernel::Point_3>& points,
             std::vector<std::array<std::size_t, 3>>& triangles)
{
  pcs::make_branch_surface(tree, points, triangles, pcs::parameters::do_join(value));
}
