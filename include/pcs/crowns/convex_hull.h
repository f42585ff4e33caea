// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Convex hulls of points in the plane, with exact predicates.

#ifndef PCS_CROWNS_CONVEX_HULL_H
#define PCS_CROWNS_CONVEX_HULL_H

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/enum.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace crowns {

using Position_2 = std::array<double, 2>; //!< two horizontal coordinates [L]

/*!
  \ingroup PkgPcsCoreRef
  \brief replaces points in the plane by the corners of their convex hull.

  The corners are in counter-clockwise order and begin with the smallest `x`, of equal `x` with the
  smallest `y`. Points on a side are no corners. Points on one line leave their two ends, equal
  points leave one. The monotone chain of \cite andrew1979 with exact orientations, so the corners
  do not depend on the order of the points.

  \pre all coordinates are finite
  \par Complexity
  \f$O(n \log n)\f$.
*/
inline void make_convex_hull(std::vector<Position_2>& points)
{
  using Point_2 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  const std::size_t n = points.size();
  if (n < 3)
    return;
  const auto point = [](const Position_2& p) { return Point_2(p[0], p[1]); };
  std::vector<Position_2> hull;
  const auto add = [&](const Position_2& p, std::size_t first) {
    while (hull.size() >= first + 2 &&
           CGAL::orientation(point(hull[hull.size() - 2]), point(hull.back()), point(p)) !=
               CGAL::LEFT_TURN)
      hull.pop_back();
    hull.push_back(p);
  };
  for (const Position_2& p : points)
    add(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = n - 1; i-- > 0;)
    add(points[i], lower);
  hull.pop_back(); // the first corner again
  points = std::move(hull);
}

//! returns the area of a polygon by the shoelace formula [L^2]; positive if it is counter-clockwise
inline double polygon_area(const std::vector<Position_2>& corners)
{
  double area = 0; // relative to the first corner, since coordinates may be large
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const double ax = corners[i - 1][0] - corners[0][0], ay = corners[i - 1][1] - corners[0][1];
    const double bx = corners[i][0] - corners[0][0], by = corners[i][1] - corners[0][1];
    area += (ax * by - bx * ay) / 2;
  }
  return area;
}

} // namespace crowns
} // namespace pcs

#endif // PCS_CROWNS_CONVEX_HULL_H
