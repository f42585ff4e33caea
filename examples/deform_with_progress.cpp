// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Progress and cancelling: a callback that returns false stops the work, and the points are
// unchanged.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  std::vector<Kernel::Point_3> points = make_pillar<Kernel::Point_3>(20000);
  const std::vector<Kernel::Point_3> before = points;
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < 2000; ++i) {
    feet.push_back(i);
    head.push_back(points.size() - 1 - i);
  }
  const auto pull = pcs::translation(Kernel::Vector_3(3, 0, 0));

  //! [progress]
  const auto show = [](double fraction) {
    std::cout << int(100 * fraction) << " % " << std::flush;
    return true; // continue
  };
  auto report = pcs::deform_point_set(points, feet, head, pull, pcs::parameters::callback(show));
  std::cout << '\n' << report.status << '\n';
  //! [progress]
  const bool is_done = points != before;

  //! [cancel]
  points = before;
  int number_of_calls = 0;
  const auto stop_soon = [&](double) { return ++number_of_calls < 3; };
  report = pcs::deform_point_set(points, feet, head, pull, pcs::parameters::callback(stop_soon));
  std::cout << report.status << '\n'; // cancelled
  //! [cancel]
  return is_done && report.status == pcs::Status::cancelled && points == before ? EXIT_SUCCESS
                                                                                : EXIT_FAILURE;
}
