// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Normals of a scan are vectors.

#include <pcs/Orl_shape_space.h>

#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Space = pcs::Orl_shape_space<>;
using Skeleton = pcs::Tree_skeleton<CGAL::Simple_cartesian<double>>;

#ifdef PCS_BREAK_THE_RULE
using Option = double;
#else
using Option = Space::Vector_3;
#endif

using Element = std::pair<Space::Point_3, Option>;

void compile(Space& space, const Skeleton& tree, const std::vector<Element>& scan)
{
  space.add(tree,
            scan,
            pcs::parameters::point_map(CGAL::First_of_pair_property_map<Element>())
                .normal_map(CGAL::Second_of_pair_property_map<Element>()));
}
