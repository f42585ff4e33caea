// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The first program of the manual: bends a pillar by its head.

//! [readme_example]
#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  std::vector<Kernel::Point_3> points; // a pillar of height 10 and radius 1
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < 20000; ++i) {
    const double angle = 2.39996 * double(i), height = double(i) / 2000;
    points.emplace_back(std::cos(angle), std::sin(angle), height);
    if (height < 1 || height > 9)
      (height < 1 ? feet : head).push_back(i);
  }

  // turn the head by 90 degrees about the y-axis through (5, 0, 5); the pillar follows
  const auto bend = pcs::rotation(Kernel::Vector_3(0, 1, 0), CGAL_PI / 2, Kernel::Point_3(5, 0, 5));
  const auto report = pcs::deform_point_set(points, feet, head, bend);

  std::cout << report.status << " after " << report.number_of_iterations << " iterations\n"
            << "the top is now at " << points.back() << '\n';
}
//! [readme_example]
