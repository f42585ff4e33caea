// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The tree of a leaf surface must be a Tree_skeleton.

#include <pcs/make_leaf_surface.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>

#include <array>
#include <cstddef>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Tree = boost::adjacency_list<>;
#else
using Tree = pcs::Tree_skeleton<Kernel>;
#endif

void compile(const Tree& tree,
             std::vector<Kernel::Point_3>& points,
             std::vector<std::array<std::size_t, 3>>& triangles)
{
  pcs::make_leaf_surface(tree, points, triangles);
}
