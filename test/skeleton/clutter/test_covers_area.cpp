// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Areas of any outline are told from lines and clusters of points.

#include <pcs/skeleton/clutter/covers_area.h>

#include <boost/test/unit_test.hpp>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace test_covers_area {

namespace {

using Places = std::vector<std::array<double, 2>>;

/// Random places in the square of the side `side` for which `is_inside(x, y)` holds.
template <class Inside>
Places random_places(std::size_t n, double side, const Inside& is_inside)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-side / 2, side / 2);
  Places places;
  while (places.size() < n) {
    const double x = place(random), y = place(random);
    if (is_inside(x, y))
      places.push_back({x, y});
  }
  return places;
}

bool covers(const Places& places, double least_side = 0)
{
  return pcs::skeleton::covers_area(places, 5, least_side, 0.75);
}

} // namespace

BOOST_AUTO_TEST_SUITE(areas_of_points)

BOOST_AUTO_TEST_CASE(areas_may_have_any_outline)
{
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 5; };
  const auto strip = [](double x, double y) { return std::abs(0.8 * x - 0.6 * y) < 0.5; };
  const auto ring = [](double x, double y) { return std::abs(std::hypot(x, y) - 4) < 0.6; };
  const auto patches = [](double x, double y) { return std::hypot(std::abs(x) - 4, y) < 0.8; };
  const auto corner = [](double x, double y) {
    return (std::abs(x) < 0.6 && y > 0) || (std::abs(y) < 0.6 && x > 0);
  };
  for (const std::size_t n : {1000u, 20000u}) {
    BOOST_TEST(covers(random_places(n, 10, disc)));
    BOOST_TEST(covers(random_places(n, 10, strip)));
    BOOST_TEST(covers(random_places(n, 10, ring)));
    BOOST_TEST(covers(random_places(n, 10, patches)));
    BOOST_TEST(covers(random_places(n, 10, corner)));
  }
}

BOOST_AUTO_TEST_CASE(density_may_vary)
{
  Places places = random_places(2000, 10, [](double, double) { return true; });
  for (const auto& p : random_places(20000, 2, [](double, double) { return true; }))
    places.push_back(p);
  BOOST_TEST(covers(places));
}

BOOST_AUTO_TEST_CASE(lines_and_clusters_are_no_areas)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  Places line, hoop, clusters;
  for (int i = 0; i < 4000; ++i) {
    const double t = share(random), angle = 6.283 * t;
    line.push_back({10 * t, 3 * t + 0.001 * share(random)});
    hoop.push_back({std::cos(angle), std::sin(angle)});
    clusters.push_back({i % 7 + 0.001 * share(random), i % 5 + 0.001 * share(random)});
  }
  BOOST_TEST(!covers(line));
  BOOST_TEST(!covers(hoop));
  BOOST_TEST(!covers(clusters, 0.01));
}

BOOST_AUTO_TEST_CASE(areas_are_wider_than_a_few_cells)
{
  const Places strip = random_places(4000, 10, [](double, double y) { return std::abs(y) < 0.1; });
  BOOST_TEST(covers(strip));
  BOOST_TEST(!covers(strip, 0.2)); // the lower side of a lying stem
}

BOOST_AUTO_TEST_CASE(degenerate_points_are_no_areas)
{
  BOOST_TEST(!covers({}));
  BOOST_TEST(!covers(Places(1000, {1, 2})));
  Places few;
  for (int i = 0; i < 40000; ++i)
    few.push_back({double(i % 40), double(i % 40 * 7 % 40)});
  BOOST_TEST(!covers(few)); // a thousand equal points in each of forty places
  BOOST_TEST(!covers(Places(1000, {1, 2}), 0.1));
  BOOST_TEST(!covers(random_places(89, 1, [](double, double) { return true; })));
  BOOST_TEST(covers(random_places(400, 1, [](double, double) { return true; })));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_covers_area
