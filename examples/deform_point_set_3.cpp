// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// CGAL::Point_set_3 (a GPL package of CGAL): its own maps are passed, and nothing is copied.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Point_set_3.h>
#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point_set = CGAL::Point_set_3<Kernel::Point_3>;

int main()
{
  Point_set points;
  points.add_normal_map();
  for (const Kernel::Point_3& p : make_pillar<Kernel::Point_3>(5000))
    points.insert(p, Kernel::Vector_3(p.x(), p.y(), 0));
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Kernel::Point_3& p = points.point(*(points.begin() + std::ptrdiff_t(i)));
    if (p.z() < 1)
      feet.push_back(i);
    else if (p.z() > 9)
      head.push_back(i);
  }

  //! [point_set_3]
  const auto lift = pcs::translation(Kernel::Vector_3(2, 0, 1));
  const auto report = pcs::deform_point_set(
      points,
      feet,
      head,
      lift,
      pcs::parameters::point_map(points.point_map()).normal_map(points.normal_map()));
  //! [point_set_3]

  std::cout << report << "\nlast point: " << points.point(*(points.end() - 1)) << '\n';
  return points.point(*(points.end() - 1)).z() > 10.9 ? EXIT_SUCCESS : EXIT_FAILURE;
}
