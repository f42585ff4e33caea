// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Region of interest: points outside are bitwise unchanged.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  std::vector<Kernel::Point_3> points = make_pillar<Kernel::Point_3>(8000);
  const std::vector<Kernel::Point_3> before = points;

  //! [region_of_interest]
  std::vector<std::size_t> region, tip;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].z() > 6)
      region.push_back(i); // the upper part may move
    if (points[i].z() > 9.5)
      tip.push_back(i); // the tip is pulled; it must be part of the region
  }
  const std::vector<std::size_t> fixed; // empty: the boundary of the region is fixed
  const auto report = pcs::deform_point_set(points,
                                            fixed,
                                            tip,
                                            pcs::translation(Kernel::Vector_3(1.5, 0, 0)),
                                            pcs::parameters::region_of_interest(std::cref(region)));
  //! [region_of_interest]

  std::size_t number_of_moved = 0, number_of_moved_outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i] != before[i])
      ++(before[i].z() > 6 ? number_of_moved : number_of_moved_outside);
  std::cout << report.status << "; " << number_of_moved << " points moved, "
            << number_of_moved_outside << " of them outside the region\n";
  return number_of_moved > tip.size() && number_of_moved_outside == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
