// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A tree of another graph type needs maps.

#include <pcs/orl_geodesic.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>

#include <vector>

namespace {

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Own_graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;
#else
using Own_graph = pcs::Tree_skeleton<Kernel>;
#endif

} // namespace

void compile(const Own_graph& one, const Own_graph& two)
{
  std::vector<Kernel::Point_3> none;
  pcs::Tree_skeleton<Kernel> middle;
  pcs::orl_geodesic(one, none, two, none, 0.5, middle, none);
}
