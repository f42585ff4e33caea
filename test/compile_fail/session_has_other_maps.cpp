// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The maps given to the constructor of a session are those of its type.

#include <pcs/Point_set_deformation.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Element = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using First = CGAL::First_of_pair_property_map<Element>;
using Second = CGAL::Second_of_pair_property_map<Element>;
using Maps = decltype(pcs::parameters::point_map(First()));

void compile(std::vector<Element>& points)
{
#ifdef PCS_BREAK_THE_RULE
  const auto np = pcs::parameters::point_map(First()).normal_map(Second());
#else
  const auto np = pcs::parameters::point_map(First()).number_of_samples(50);
#endif
  pcs::Point_set_deformation<std::vector<Element>, Maps> session(points, np);
}
