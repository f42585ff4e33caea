// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of a user-defined type: a property map gives access to the position.

#include "pillar.h"
#include <pcs/deform_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <vector>

//! [own_point_type]
struct Return
{
  float xyz[3];
  std::uint16_t intensity;
};

using Point = CGAL::Simple_cartesian<float>::Point_3;

struct Position_map
{
  using key_type = Return;
  using value_type = Point;
  using reference = Point;
  using category = boost::read_write_property_map_tag;

  friend Point get(const Position_map&, const Return& r) { return {r.xyz[0], r.xyz[1], r.xyz[2]}; }
  friend void put(const Position_map&, Return& r, const Point& p)
  {
    for (int i = 0; i < 3; ++i)
      r.xyz[i] = p[i];
  }
};
//! [own_point_type]

int main()
{
  std::vector<Return> scan;
  std::vector<std::size_t> feet, head;
  for (const Point& p : make_pillar<Point>(5000)) {
    if (p.z() < 1 || p.z() > 9)
      (p.z() < 1 ? feet : head).push_back(scan.size());
    scan.push_back({{p.x(), p.y(), p.z()}, std::uint16_t(scan.size())});
  }

  //! [own_map]
  const auto grow = pcs::scaling(1.5, Point(0, 0, 10));
  const auto report =
      pcs::deform_point_set(scan, feet, head, grow, pcs::parameters::point_map(Position_map()));
  //! [own_map]

  const Return& last = scan.back();
  std::cout << report.status << "; the last point is now at " << last.xyz[0] << ' ' << last.xyz[1]
            << ' ' << last.xyz[2] << '\n';
  const float radius = std::hypot(last.xyz[0], last.xyz[1]);
  return std::abs(radius - 1.5f) < 1e-5f && last.intensity == 4999 ? EXIT_SUCCESS : EXIT_FAILURE;
}
