// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The coordinate step is detected for decimals and for 32-bit floats; exact coordinates have none.

#include <pcs/skeleton/scan/measure_coordinate_step.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_measure_coordinate_step {

using Vec3 = Eigen::Vector3d;
using pcs::skeleton::Coordinate_step;
using pcs::skeleton::measure_coordinate_step;

/// Points of an upright cylinder of radius 0.2 and height 10 around `center`.
std::vector<Vec3> cylinder(std::size_t n, const Vec3& center)
{
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = 6.283185307179586 * uniform(random), h = 10 * uniform(random);
    points.push_back(center + Vec3(0.2 * std::cos(a), 0.2 * std::sin(a), h));
  }
  return points;
}

template <class Round>
std::vector<Vec3> rounded(std::vector<Vec3> points, const Round& round)
{
  for (Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = round(p[axis]);
  return points;
}

BOOST_AUTO_TEST_SUITE(coordinate_step)

BOOST_AUTO_TEST_CASE(exact_coordinates_have_no_step)
{
  for (const std::size_t n : {10u, 1000u, 100000u})
    BOOST_TEST(measure_coordinate_step(cylinder(n, Vec3(3, 4, 5))).step == 0, n << " points");
}

BOOST_AUTO_TEST_CASE(decimals_are_found)
{
  for (const double step : {0.001, 0.01, 0.05}) {
    const auto points = rounded(cylinder(30000, Vec3(500000, 5000000, 200)),
                                [&](double x) { return std::round(x / step) * step; });
    const Coordinate_step found = measure_coordinate_step(points);
    BOOST_TEST(std::abs(found.step - step) < 1e-3 * step, step << " and " << found.step);
    BOOST_TEST(!found.is_single_precision);
  }
}

BOOST_AUTO_TEST_CASE(single_precision_far_from_the_origin_is_named)
{
  const auto points = rounded(cylinder(30000, Vec3(592783, 5715588.3, 248)),
                              [](double x) { return double(float(x)); });
  const Coordinate_step found = measure_coordinate_step(points);
  BOOST_TEST(found.step == 0.5); // numbers from 2^22 to 2^23
  BOOST_TEST(found.is_single_precision);
}

BOOST_AUTO_TEST_CASE(few_or_equal_points_have_no_step)
{
  BOOST_TEST(measure_coordinate_step({}).step == 0);
  BOOST_TEST(measure_coordinate_step({Vec3(1, 2, 3)}).step == 0);
  BOOST_TEST(measure_coordinate_step(std::vector<Vec3>(1000, Vec3(1, 2, 3))).step == 0);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_measure_coordinate_step
