// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A given skeleton of another graph type needs a position map.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Given = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;
#else
using Given = pcs::Tree_skeleton<Kernel>;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             const Given& given,
             pcs::Tree_skeleton<Kernel>& tree)
{
  pcs::extract_tree_skeleton(points, tree, pcs::parameters::given_skeleton(given));
}
