// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Nonrigid registration: a complete scan is deformed onto a scan of the bent object with a hole,
// and fills this hole.

#include "pillar.h"
#include <pcs/registration/fit_point_set.h>

#include <CGAL/Simple_cartesian.h>

#include <boost/property_map/property_map.hpp>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

/// Bends about the y axis.
Point bend(const Point& p)
{
  const double k = 0.1, r = 1 / k - p.x();
  return Point(1 / k - r * std::cos(k * p.z()), p.y(), r * std::sin(k * p.z()));
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
  std::vector<Point> source = make_pillar<Point>(4000), target, truth;
  for (const Point& p : source)
    truth.push_back(bend(p));
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

  double sum = 0;
  for (std::size_t i = 0; i < source.size(); ++i)
    sum += CGAL::squared_distance(source[i], truth[i]);
  const double error = std::sqrt(sum / static_cast<double>(source.size()));
  std::cout << report << "\n"
            << filled.size() - target.size() << " points fill the hole, error " << error << '\n';
  return report.is_plausible && error < 0.02 * height ? EXIT_SUCCESS : EXIT_FAILURE;
}
