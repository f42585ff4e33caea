// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Targets per point: each point of a handle has a position of its own to reach.

#include "pillar.h"
#include <pcs/Point_set_deformation.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  std::vector<Kernel::Point_3> points = make_pillar<Kernel::Point_3>(3000);
  std::vector<std::size_t> feet(300), head(300);
  std::iota(feet.begin(), feet.end(), std::size_t(0));
  std::iota(head.begin(), head.end(), points.size() - head.size());

  //! [targets]
  std::vector<Kernel::Point_3> targets; // the head becomes oval, and is lifted by 1
  for (const std::size_t i : head)
    targets.emplace_back(1.5 * points[i].x(), 0.7 * points[i].y(), points[i].z() + 1);

  pcs::Point_set_deformation session(points);
  session.add_handle(feet);
  const auto handle = session.add_handle(head);
  session.set_targets(handle, targets); // in the order of `head`
  session.deform();
  //! [targets]

  bool is_reached = true;
  for (std::size_t k = 0; k < head.size(); ++k)
    is_reached = is_reached && points[head[k]] == targets[k];
  std::cout << "lifted by " << session.transformation(handle).translation().z() << ", the head is "
            << (is_reached ? "at" : "not at") << " its targets\n";
  return is_reached ? EXIT_SUCCESS : EXIT_FAILURE;
}
