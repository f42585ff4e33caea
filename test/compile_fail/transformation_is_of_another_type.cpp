// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A transformation is a Similarity or an Aff_transformation_3.

#include <pcs/Point_set_deformation.h>

#include <CGAL/Aff_transformation_3.h>
#include <CGAL/Simple_cartesian.h>

#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

#ifdef PCS_BREAK_THE_RULE
using Transformation = Kernel::Vector_3;
#else
using Transformation = CGAL::Aff_transformation_3<Kernel>;
#endif

void compile(std::vector<Kernel::Point_3>& points, const Transformation& transformation)
{
  pcs::Point_set_deformation session(points);
  session.set_transformation(session.add_handle(std::vector<int>{0}), transformation);
}
