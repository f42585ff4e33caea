// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/clutter/Terrain.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

namespace test_Terrain {

namespace {

using pcs::skeleton::Terrain;
using pcs::skeleton::Vec3;

constexpr double slope = 0.5, pi = 3.14159265358979323846;

double relief(double x, double y)
{
  return slope * x + 0.1 * std::sin(1.5 * y);
}

/// A hill with a pole, or the pole alone with twigs.
std::vector<Vec3> hill(bool has_ground)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-3, 3), share(0, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < 20000 && has_ground; ++i) {
    const double x = place(random), y = place(random);
    points.emplace_back(x, y, relief(x, y));
  }
  for (int i = 0; i < 4000; ++i) {
    const double a = 6.28318 * share(random);
    points.emplace_back(0.1 * std::cos(a), 0.1 * std::sin(a), 5 * share(random));
  }
  for (int twig = 0; twig < 200; ++twig) {
    const double a = 6.28318 * share(random), height = 2 + 3 * share(random);
    for (int i = 0; i < 40; ++i) {
      const double r = 2 * share(random);
      points.emplace_back(r * std::cos(a), r * std::sin(a), height);
    }
  }
  return points;
}

struct Found
{
  std::vector<Vec3> points;
  pcs::skeleton::Scan scan;
  std::vector<std::uint8_t> is_used;
  std::optional<Terrain> terrain;

  explicit Found(bool has_ground) : points(hill(has_ground))
  {
    pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
    is_used.assign(scan.size(), 1);
    terrain = pcs::skeleton::find_terrain(scan, Vec3::UnitZ(), {}, is_used);
  }

  /// Height above the terrain, in the unit of the input.
  double height(const Vec3& p) const
  {
    return scan.frame.unit * terrain->height(scan.frame.to_local(p));
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(terrain)

BOOST_AUTO_TEST_CASE(heights_are_measured_from_a_slope_with_relief)
{
  const Found found(true);
  BOOST_REQUIRE(found.terrain);
  for (const double x : {-2.0, -0.7, 1.3, 2.4})
    for (const double y : {-2.2, -0.4, 1.1}) {
      const Vec3 ground(x, y, relief(x, y));
      BOOST_TEST(std::abs(found.height(ground)) < 0.02);
      BOOST_TEST(std::abs(found.height(ground + 3 * Vec3::UnitZ()) - 3) < 0.02);
    }
  const double noise = found.scan.frame.unit * found.terrain->noise(found.scan, found.is_used);
  BOOST_TEST(noise > 0);
  BOOST_TEST(noise < 0.02);
}

BOOST_AUTO_TEST_CASE(the_slope_goes_on_beyond_the_border)
{
  const Found found(true);
  BOOST_REQUIRE(found.terrain);
  BOOST_TEST(std::abs(found.height(Vec3(5, 0, slope * 5))) < 0.25);
}

// Within the disc, the surface is interpolated from its surroundings, independent of the points
// inside.
BOOST_AUTO_TEST_CASE(a_bridge_hides_what_is_in_the_middle)
{
  Found found(true);
  BOOST_REQUIRE(found.terrain);
  const double unit = found.scan.frame.unit;
  Terrain bridged = *found.terrain;
  const Vec3 top(0, pi / 3, relief(0, pi / 3)); // crest of a wave
  bridged.bridge(found.scan.frame.to_local(top), 1 / unit);
  const Vec3 outside = found.scan.frame.to_local(Vec3(-2.5, -2, 0));
  BOOST_TEST(bridged.height(outside) == found.terrain->height(outside));
  BOOST_TEST(std::abs(found.height(top)) < 0.02);
  BOOST_TEST(unit * bridged.height(found.scan.frame.to_local(top)) > 0.04);
}

BOOST_AUTO_TEST_CASE(the_underside_of_a_crown_is_no_terrain)
{
  BOOST_TEST(!Found(false).terrain.has_value());
}

// A whorl of dense branches hides most of the lower stem. Points of the stem lie below each other,
// stray points below the ground do not.
BOOST_AUTO_TEST_CASE(a_whorl_above_a_thin_stem_is_no_terrain)
{
  for (const bool has_stem : {true, false}) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<Vec3> points;
    for (int i = 0; i < 6000; ++i)
      points.emplace_back(3 * share(random) - 1.5, 3 * share(random) - 1.5, 0);
    for (int i = 0; i < 3000; ++i) {
      const double a = 2 * pi * share(random);
      points.emplace_back(0.15 * std::cos(a), 0.15 * std::sin(a), 6 * share(random));
    }
    for (int i = 0; i < 100; ++i) {
      const double a = 2 * pi * share(random), r = has_stem ? 0.15 : 1.5 * share(random);
      points.emplace_back(r * std::cos(a), r * std::sin(a), -4 * share(random));
    }
    pcs::skeleton::Scan scan;
    pcs::skeleton::prepare_scan<CGAL::Sequential_tag>(points, Vec3::UnitZ(), scan);
    const std::vector<std::uint8_t> is_used(scan.size(), 1);
    const auto terrain = pcs::skeleton::find_terrain(scan, Vec3::UnitZ(), {}, is_used);
    BOOST_TEST(terrain.has_value() == !has_stem);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Terrain
