// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Other kernels and transformations of CGAL: Epick and Aff_transformation_3.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Aff_transformation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

int main()
{
  //! [own_kernel]
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points = make_pillar<Kernel::Point_3>(5000);
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < 500; ++i) {
    feet.push_back(i);
    head.push_back(points.size() - 1 - i);
  }
  const Kernel::Point_3 top = points.back();

  // a rotation by 90 degrees about the z-axis and a translation upwards; shear is rejected
  const CGAL::Aff_transformation_3<Kernel> motion(0,
                                                  -1,
                                                  0,
                                                  0, //
                                                  1,
                                                  0,
                                                  0,
                                                  0, //
                                                  0,
                                                  0,
                                                  1,
                                                  2);
  const auto report = pcs::deform_point_set(points, feet, head, motion);
  //! [own_kernel]

  const double error = CGAL::squared_distance(points.back(), motion.transform(top));
  std::cout << report.status << "; the top is off its target by " << std::sqrt(error) << '\n';
  return error < 1e-20 ? EXIT_SUCCESS : EXIT_FAILURE;
}
