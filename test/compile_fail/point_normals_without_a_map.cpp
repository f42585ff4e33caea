// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Normals need a property map to which they are written.

#include <pcs/Orl_shape_space.h>

#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Space = pcs::Orl_shape_space<>;
using Oriented = std::pair<Space::Point_3, Space::Vector_3>;
using Points = std::vector<Oriented>;

void compile(const Space& space, const pcs::Orl_tree& tree, Points& result)
{
  const auto positions = pcs::parameters::point_map(CGAL::First_of_pair_property_map<Oriented>());
#ifdef PCS_BREAK_THE_RULE
  const auto maps = positions;
#else
  const auto maps = positions.normal_map(CGAL::Second_of_pair_property_map<Oriented>());
#endif
  space.points(tree, result, maps.point_normals(pcs::Point_normals::across_branches));
}
