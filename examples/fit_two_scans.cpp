// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nonrigid registration: a complete scan is deformed onto a scan of the bent object with a hole,
// and fills this hole.

#include "pillar.h"
#include <pcs/registration/fit_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

constexpr double curvature = 0.1;

/// Bends about the y axis.
Point bend(const Point& p)
{
  const double r = 1 / curvature - p.x(), angle = curvature * p.z();
  return Point(1 / curvature - r * std::cos(angle), p.y(), r * std::sin(angle));
}

/// Distance from the surface of the bent pillar of radius 1.
double distance_from_bent_pillar(const Point& p)
{
  const double x = 1 / curvature - std::hypot(1 / curvature - p.x(), p.z());
  return std::abs(std::hypot(x, p.y()) - 1);
}

/// Writes whether the point `i` is matched.
struct Is_matched_map
{
  using key_type = Point;
  using value_type = bool;
  using reference = void;
  using category = boost::writable_property_map_tag;

  const std::vector<Point>* points;
  std::vector<char>* values;
  friend void put(const Is_matched_map& map, const Point& p, bool value)
  {
    (*map.values)[static_cast<std::size_t>(&p - map.points->data())] = value;
  }
};

int main()
{
  std::vector<Point> source = make_pillar<Point>(4000), target;
  const double height = source.back().z();
  for (const Point& p : make_pillar<Point>(5000)) // another sampling, with a hole on one side
    if (!(p.x() > 0 && std::abs(p.z() - 0.5 * height) < 0.1 * height))
      target.push_back(bend(p));

  //! [fit]
  std::vector<char> is_matched(source.size(), 0);
  const pcs::Fit_report report = pcs::fit_point_set(
      source,
      target,
      pcs::parameters::point_is_matched_map(Is_matched_map{&source, &is_matched}));

  std::vector<Point> filled = target; // with the points in the hole
  for (std::size_t i = 0; i < source.size(); ++i)
    if (!is_matched[i])
      filled.push_back(source[i]);
  //! [fit]

  double farthest = 0;
  for (std::size_t i = target.size(); i < filled.size(); ++i)
    farthest = std::max(farthest, distance_from_bent_pillar(filled[i]));
  std::cout << report << '\n'
            << filled.size() - target.size() << " points fill the hole, at most " << farthest
            << " from the true surface\n";
  return report.is_plausible && farthest < 0.1 ? EXIT_SUCCESS : EXIT_FAILURE;
}
