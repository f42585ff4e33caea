// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points with normals as pairs: the normals rotate with the surface.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point_with_normal = std::pair<Kernel::Point_3, Kernel::Vector_3>;

int main()
{
  std::vector<Point_with_normal> points;
  for (const Kernel::Point_3& p : make_pillar<Kernel::Point_3>(5000))
    points.emplace_back(p, Kernel::Vector_3(p.x(), p.y(), 0));
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < 500; ++i) {
    feet.push_back(i);
    head.push_back(points.size() - 1 - i);
  }

  //! [normals]
  const auto bend = pcs::rotation(Kernel::Vector_3(0, 1, 0), CGAL_PI / 2, Kernel::Point_3(5, 0, 5));
  const auto report = pcs::deform_point_set(
      points,
      feet,
      head,
      bend,
      pcs::parameters::point_map(CGAL::First_of_pair_property_map<Point_with_normal>())
          .normal_map(CGAL::Second_of_pair_property_map<Point_with_normal>()));
  //! [normals]

  const Kernel::Vector_3& normal = points.back().second; // was (x, y, 0): now x points down
  std::cout << report.status << "; the normal of the last point is now " << normal << '\n';
  return std::abs(normal.x()) < 1e-9 && std::abs(normal.squared_length() - 1) < 1e-9 ? EXIT_SUCCESS
                                                                                     : EXIT_FAILURE;
}
