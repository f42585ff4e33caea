// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The gradient map must take 3 x 3 matrices.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Element = std::pair<Kernel::Point_3, Eigen::Matrix2d>;
#else
using Element = std::pair<Kernel::Point_3, Eigen::Matrix3d>;
#endif

void compile(std::vector<Element>& points, const std::vector<int>& handle)
{
  pcs::deform_point_set(points,
                        handle,
                        handle,
                        pcs::Similarity(),
                        pcs::parameters::point_map(CGAL::First_of_pair_property_map<Element>())
                            .gradient_map(CGAL::Second_of_pair_property_map<Element>()));
}
