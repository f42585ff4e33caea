// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Soft handles: springs pull points to their targets; a softer handle stays farther away.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  const std::vector<Kernel::Point_3> at_rest = make_pillar<Kernel::Point_3>(3000);
  std::vector<std::size_t> feet(300), head(300);
  std::iota(feet.begin(), feet.end(), std::size_t(0));
  std::iota(head.begin(), head.end(), at_rest.size() - head.size());

  //! [soft_handles]
  double last_x = 100;
  bool is_ordered = true;
  for (const double softness : {0.0, 1.0, 100.0}) { // 0: exactly at the target
    std::vector<Kernel::Point_3> points = at_rest;
    const std::vector<pcs::Deformation_handle> handles = {
        {feet, pcs::Similarity(), 0},
        {head, pcs::translation(Kernel::Vector_3(4, 0, 0)), softness}};
    pcs::deform_point_set(points, handles);

    double x = 0;
    for (const std::size_t i : head)
      x += (points[i].x() - at_rest[i].x()) / double(head.size());
    std::cout << "softness " << softness << ": the head moved by " << x << " of 4\n";
    is_ordered = is_ordered && x < last_x;
    last_x = x;
  }
  //! [soft_handles]
  return is_ordered ? EXIT_SUCCESS : EXIT_FAILURE;
}
