// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The largest radius of branches with leaves must be a number.

#include <pcs/make_leaf_surface.h>

#include <CGAL/Simple_cartesian.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Value = std::string;
#else
using Value = float;
#endif

void compile(const pcs::Tree_skeleton<Kernel>& tree,
             const Value& value,
             std::vector<Kernel::Point_3>& points,
             std::vector<std::array<std::size_t, 3>>& triangles)
{
  pcs::make_leaf_surface(tree, points, triangles, pcs::parameters::leaf_branch_radius(value));
}
