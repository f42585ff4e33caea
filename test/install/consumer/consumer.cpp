// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Minimal program with pcs: lifts one end of a sheet.

#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstddef>
#include <iostream>
#include <vector>

#if __has_include(<pcs/version.h>) // not in a copy of the headers
#include <pcs/version.h>
static_assert(PCS_VERSION_NUMBER >= 100, "0.1.0 or later");
#endif

using Kernel = CGAL::Simple_cartesian<double>;

int main()
{
  std::vector<Kernel::Point_3> points;
  std::vector<std::size_t> fixed, moved;
  for (int x = 0; x <= 30; ++x)
    for (int y = 0; y <= 10; ++y) {
      if (x <= 1)
        fixed.push_back(points.size());
      if (x >= 29)
        moved.push_back(points.size());
      points.emplace_back(x, y, 0);
    }
  const auto report = pcs::deform_point_set(
      points,
      fixed,
      moved,
      pcs::rotation(Kernel::Vector_3(0, -1, 0), 0.5, Kernel::Point_3(15, 5, 0)));
  std::cout << report << '\n';
  const double height = 14 * std::sin(0.5); // of the end at x = 29
  return std::abs(points[fixed.front()].z()) < 1e-9 &&
                 std::abs(points[moved.front()].z() - height) < 1e-9
             ? 0
             : 1;
}
