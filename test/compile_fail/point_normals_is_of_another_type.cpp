// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `point_normals` is a value of an enumeration.

#include <pcs/Orl_shape_space.h>

#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Point_normals;
#endif

using Oriented = std::pair<Space::Point_3, Space::Vector_3>;
using Points = std::vector<Oriented>;

void compile(const Space& space, const pcs::Orl_tree& tree, Points& result, const Option& value)
{
  const auto maps = pcs::parameters::point_map(CGAL::First_of_pair_property_map<Oriented>())
                        .normal_map(CGAL::Second_of_pair_property_map<Oriented>());
  space.points(tree, result, maps.point_normals(value));
}
