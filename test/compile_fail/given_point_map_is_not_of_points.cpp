// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The map of a given skeleton must store points.

#include <pcs/extract_tree_skeleton.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/property_map/property_map.hpp>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Given = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS>;

#ifdef PCS_BREAK_THE_RULE
using Value = double;
#else
using Value = Kernel::Point_3;
#endif

void compile(const std::vector<Kernel::Point_3>& points,
             const Given& given,
             std::vector<Value>& values,
             pcs::Tree_skeleton<Kernel>& tree)
{
  const auto map =
      boost::make_iterator_property_map(values.begin(), get(boost::vertex_index, given));
  pcs::extract_tree_skeleton(points,
                             tree,
                             pcs::parameters::given_skeleton(given).given_point_map(map));
}
