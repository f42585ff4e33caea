// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests convex hulls: corners of known shapes, independence of the order, degenerate points.

#include <pcs/crowns/convex_hull.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_convex_hull {

using pcs::crowns::make_convex_hull;
using pcs::crowns::polygon_area;
using Points = std::vector<pcs::crowns::Position_2>;

BOOST_AUTO_TEST_SUITE(convex_hull)

BOOST_AUTO_TEST_CASE(a_square_has_four_corners)
{
  Points points;
  for (int i = 0; i <= 10; ++i)
    for (int k = 0; k <= 10; ++k)
      points.push_back({500000 + 0.1 * i, 5400000 + 0.1 * k});
  // 0.1 * i is rounded, so points of a side may lie outside of it by one unit in the last place
  const Points all = points;
  make_convex_hull(points);
  BOOST_TEST(points.size() < 20u);
  BOOST_TEST((points.front() == pcs::crowns::Position_2{500000, 5400000}));
  BOOST_TEST(std::abs(polygon_area(points) - 1) < 1e-9);

  Points integers;
  for (int i = 0; i <= 10; ++i)
    for (int k = 0; k <= 5; ++k)
      integers.push_back({double(i), double(k)});
  make_convex_hull(integers);
  BOOST_TEST((integers == Points{{0, 0}, {10, 0}, {10, 5}, {0, 5}}));
  BOOST_TEST(polygon_area(integers) == 50);
}

BOOST_AUTO_TEST_CASE(degenerate_points)
{
  Points points;
  make_convex_hull(points);
  BOOST_TEST(points.empty());
  BOOST_TEST(polygon_area(points) == 0);
  points = {{3, 4}, {3, 4}, {3, 4}};
  make_convex_hull(points);
  BOOST_TEST((points == Points{{3, 4}}));
  points = {{2, 2}, {0, 0}, {1, 1}, {3, 3}, {1, 1}};
  make_convex_hull(points);
  BOOST_TEST((points == Points{{0, 0}, {3, 3}}));
  BOOST_TEST(polygon_area(points) == 0);
}

BOOST_AUTO_TEST_CASE(corners_do_not_depend_on_the_order_and_contain_all_points)
{
  std::mt19937 engine(3);
  const auto random = [&engine] { return double(engine()) / 4294967296.0; };
  for (int run = 0; run < 20; ++run) {
    Points points;
    for (int i = 0; i < 200; ++i) // nearly on one line
      points.push_back({500000 + 0.1 * double(engine() % 50), 0});
    for (auto& p : points)
      p[1] = 3 * p[0] + (run % 2 == 0 ? 0 : 1e-9 * random());
    Points hull = points, other = points;
    std::shuffle(other.begin(), other.end(), engine);
    make_convex_hull(hull);
    make_convex_hull(other);
    BOOST_TEST((hull == other));
    Points again = hull; // a part of the points first
    again.insert(again.end(), points.begin(), points.begin() + 100);
    make_convex_hull(again);
    BOOST_TEST((hull == again));
    for (std::size_t i = 0; i < hull.size() && hull.size() > 2; ++i) {
      const auto& a = hull[i];
      const auto& b = hull[(i + 1) % hull.size()];
      for (const auto& p : points) {
        const double side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        BOOST_REQUIRE(side > -1e-8);
      }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_convex_hull
