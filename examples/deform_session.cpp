// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// An interactive session: handles move repeatedly; states are saved and restored.

#include "pillar.h"
#include <pcs/Point_set_deformation.h>

#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  std::vector<Kernel::Point_3> points = make_pillar<Kernel::Point_3>(5000);
  const std::vector<Kernel::Point_3> at_rest = points;
  std::vector<std::size_t> feet, head;
  for (std::size_t i = 0; i < 500; ++i) {
    feet.push_back(i);
    head.push_back(points.size() - 1 - i);
  }

  //! [session]
  pcs::Point_set_deformation session(points, pcs::parameters::number_of_samples(500));
  session.add_handle(feet);
  const auto handle = session.add_handle(head);

  // two full turns: the head ends where it began, the pillar in between is twisted
  const Kernel::Vector_3 up(0, 0, 1);
  session.set_rotation(handle, up, 4 * CGAL_PI);
  std::cout << session.deform() << '\n';
  //! [session]
  std::cout << "three eighths up, a point moved by "
            << std::sqrt(CGAL::squared_distance(points[1875], at_rest[1875])) << '\n';

  //! [snapshot]
  const auto twisted = session.snapshot();
  const std::vector<Kernel::Point_3> twisted_points = points;

  session.set_translation(handle, Kernel::Vector_3(0, 0, 3)); // stretched as well
  session.deform();
  session.restore(twisted); // twisted only
  const bool is_restored = points == twisted_points;

  session.reset(); // at rest
  //! [snapshot]
  double error = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    error = std::max(error, CGAL::squared_distance(points[i], at_rest[i]));

  //! [drag]
  // Frames of a drag start from the previous frame; the final result depends on the last position
  // only.
  std::size_t passes = 0;
  for (int frame = 1; frame <= 30; ++frame) {
    session.set_rotation(handle, Kernel::Vector_3(1, 0, 0), frame * CGAL_PI / 180);
    passes += session.deform(pcs::Solver_start::warm).number_of_iterations;
  }
  session.deform();
  //! [drag]
  std::cout << passes << " passes for 30 frames\n";

  //! [accept]
  // The current shape becomes the rest shape of the next motion.
  session.set_rotation(handle, Kernel::Vector_3(1, 0, 0), CGAL_PI / 6);
  session.deform();
  session.accept();
  session.set_translation(handle, Kernel::Vector_3(0, 1, 0));
  session.deform();
  //! [accept]

  std::cout << "restored " << is_restored << ", off by " << std::sqrt(error) << " after reset\n";
  return is_restored && error < 1e-20 ? EXIT_SUCCESS : EXIT_FAILURE;
}
