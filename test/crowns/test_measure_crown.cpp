// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests measure_crown(): known shapes, laws, memory of layers, rejection of invalid input.

#include <pcs/core/errors.h>
#include <pcs/crowns/measure_crown.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/number_type_basic.h>

#include <boost/property_map/property_map.hpp>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <random>
#include <vector>

namespace test_measure_crown {

using Kernel = CGAL::Simple_cartesian<double>;
using Points = std::vector<Kernel::Point_3>;

namespace {

/// Points in a stem of radius 0.1 up to height 4, and in a cone of radius 3 at height 4 with its
/// tip at height 10, far from the origin.
Points make_tree(std::size_t n)
{
  std::mt19937 engine(1);
  const auto random = [&engine] { return double(engine()) / 4294967296.0; };
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_stem = i % 10 == 0;
    const double z = is_stem ? 4 * random() : 4 + 6 * random();
    const double r = (is_stem ? 0.1 : 3 * (10 - z) / 6) * std::sqrt(random());
    const double angle = 2 * CGAL_PI * random();
    points.emplace_back(500000 + r * std::cos(angle), 5400000 + r * std::sin(angle), 300 + z);
  }
  return points;
}

} // namespace

BOOST_AUTO_TEST_SUITE(measure_crown)

BOOST_AUTO_TEST_CASE(a_cone_has_its_area_and_volume)
{
  const Points points = make_tree(400000);
  const auto crown = pcs::crowns::measure_crown(points, 301.3);
  std::size_t above = 0;
  for (const auto& p : points)
    above += p.z() >= 301.3;
  BOOST_TEST(crown.number_of_points == above);
  BOOST_TEST(std::abs(crown.area / (9 * CGAL_PI) - 1) < 0.04);
  BOOST_TEST(crown.area < 9 * CGAL_PI);
  // a layer counts with its largest section, here the lowest one: the sum of a staircase
  double expected = 0;
  for (int k = 0; k < 18; ++k) {
    const double low = std::max(4.0, 1.3 + 0.5 * k);
    if (low < 10 && 1.3 + 0.5 * (k + 1) > 4)
      expected += 0.5 * CGAL_PI * std::pow(3 * (10 - low) / 6, 2);
  }
  BOOST_TEST(std::abs(crown.volume / expected - 1) < 0.03);
  // thin layers give the volume of the cone itself
  const double cone = CGAL_PI * 9 * 6 / 3;
  BOOST_TEST(std::abs(pcs::crowns::measure_crown(points, 301.3, 0.05).volume / cone - 1) < 0.05);
}

BOOST_AUTO_TEST_CASE(a_box_is_exact)
{
  Points points;
  for (int layer = 0; layer < 4; ++layer)
    for (int corner = 0; corner < 4; ++corner)
      points.emplace_back(2 * (corner % 2), 3 * (corner / 2), 0.5 * layer);
  const auto crown = pcs::crowns::measure_crown(points, 0.0);
  BOOST_TEST(crown.area == 6);
  BOOST_TEST(crown.volume == 12);
  BOOST_TEST(
      (crown.outline == std::vector<pcs::crowns::Position_2>{{0, 0}, {2, 0}, {2, 3}, {0, 3}}));
  BOOST_TEST(pcs::crowns::measure_crown(points, 0.5).volume ==
             9); // a point at the base belongs to the crown
  BOOST_TEST(pcs::crowns::measure_crown(points, 0.75).volume == 6);
  BOOST_TEST(pcs::crowns::measure_crown(points, 9.0).area == 0);
  BOOST_TEST(pcs::crowns::measure_crown(Points(), 0.0).outline.empty());
}

BOOST_AUTO_TEST_CASE(laws)
{
  Points points = make_tree(3000);
  const auto crown = pcs::crowns::measure_crown(points, 302);
  std::mt19937 engine(2);
  std::shuffle(points.begin(), points.end(), engine);
  const auto shuffled = pcs::crowns::measure_crown(points, 302);
  BOOST_TEST(shuffled.area == crown.area);
  BOOST_TEST(shuffled.volume == crown.volume);
  BOOST_TEST((shuffled.outline == crown.outline));
  Points large;
  for (const auto& p : points)
    large.emplace_back(10 * (p.x() - 500000), 10 * (p.y() - 5400000), 10 * (p.z() - 302));
  const auto scaled = pcs::crowns::measure_crown(large, 0, 5);
  BOOST_TEST(std::abs(scaled.area / crown.area - 100) < 1e-6);
  BOOST_TEST(std::abs(scaled.volume / crown.volume - 1000) < 1e-5);
  points.resize(2000);
  BOOST_TEST(pcs::crowns::measure_crown(points, 302).volume <= crown.volume);

  std::map<int, Kernel::Point_3> positions; // a property map of indices
  std::vector<int> indices;
  for (std::size_t i = 0; i < points.size(); ++i) {
    indices.push_back(int(i));
    positions[int(i)] = points[i];
  }
  const auto map = boost::make_assoc_property_map(positions);
  BOOST_TEST(pcs::crowns::measure_crown(indices, 302, 0.5, pcs::parameters::point_map(map)).area ==
             pcs::crowns::measure_crown(points, 302).area);
}

BOOST_AUTO_TEST_CASE(invalid_input_is_refused)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Points points = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  BOOST_CHECK_THROW(pcs::crowns::measure_crown(points, nan), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::crowns::measure_crown(points, 0, 0), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::crowns::measure_crown(points, 0, nan), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::crowns::measure_crown(points, -1e10, 0.5), pcs::Invalid_input);
  BOOST_CHECK_THROW(pcs::crowns::measure_crown(Points{{nan, 0, 1}}, 0), pcs::Invalid_input);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_measure_crown
