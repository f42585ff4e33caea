// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0

#include <pcs/skeleton/forest/Sparse_ground.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace test_Sparse_ground {

namespace {

using pcs::skeleton::Scan;
using pcs::skeleton::Sparse_ground_options;
using pcs::skeleton::Vec3;
using pcs::skeleton::internal::Sparse_ground;

constexpr double slope = 0.4, pi = 3.14159265358979323846, noise = 0.02;

double relief(double x, double y)
{
  return slope * x + 0.3 * std::sin(0.4 * y);
}

/// Trees and shrubs on a slope of 20 x 20 m, with a given density of ground points per square
/// metre.
struct Slope
{
  Scan scan;
  std::size_t number_of_ground_points;

  explicit Slope(double ground_density)
    : number_of_ground_points(static_cast<std::size_t>(400 * ground_density))
  {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(0, 20), unit(0, 1);
    std::normal_distribution<double> error(0, noise);
    for (std::size_t i = 0; i < number_of_ground_points; ++i) {
      const double x = place(random), y = place(random);
      scan.points.emplace_back(x, y, relief(x, y) + error(random));
    }
    for (int tree = 0; tree < 12; ++tree) {
      const double x = place(random), y = place(random);
      for (int i = 0; i < 2000; ++i) {
        const double angle = 2 * pi * unit(random), height = 20 * unit(random);
        scan.points.emplace_back(x + 0.2 * std::cos(angle),
                                 y + 0.2 * std::sin(angle),
                                 relief(x, y) + 0.3 + height);
        const double crown = 4 * std::sqrt(unit(random));
        scan.points.emplace_back(x + crown * std::cos(angle),
                                 y + crown * std::sin(angle),
                                 relief(x, y) + 10 + 0.5 * height);
      }
    }
    for (int shrub = 0; shrub < 20; ++shrub) {
      const double x = place(random), y = place(random);
      for (int i = 0; i < 300; ++i)
        scan.points.emplace_back(x + unit(random),
                                 y + unit(random),
                                 relief(x + 0.5, y) + 0.6 + unit(random));
    }
  }

  Sparse_ground ground() const
  {
    static const Sparse_ground_options rules;
    return Sparse_ground(scan, 1.3, rules, std::vector<std::uint8_t>(scan.size(), 1));
  }
};

} // namespace

BOOST_AUTO_TEST_SUITE(sparse_ground)

BOOST_AUTO_TEST_CASE(few_points_on_a_slope_are_ground)
{
  for (const double density : {1.0, 3.0, 7.0, 30.0}) {
    const Slope slope_with_trees(density);
    const Sparse_ground ground = slope_with_trees.ground();
    BOOST_TEST(ground.is_found(), "density " << density);
    BOOST_TEST(ground.thickness() < 0.2, "density " << density << ": " << ground.thickness());
    std::size_t found = 0, others = 0;
    for (std::size_t i = 0; i < slope_with_trees.scan.size(); ++i) {
      const bool is_ground = ground.height(slope_with_trees.scan.points[i]) <= ground.thickness();
      (i < slope_with_trees.number_of_ground_points ? found : others) += is_ground;
    }
    BOOST_TEST(double(found) >= 0.9 * double(slope_with_trees.number_of_ground_points),
               "density " << density << ": " << found);
    BOOST_TEST(double(others) <= 0.01 * double(slope_with_trees.scan.size()),
               "density " << density << ": " << others);
  }
}

BOOST_AUTO_TEST_CASE(a_stand_without_ground_has_none)
{
  BOOST_TEST(!Slope(0).ground().is_found());
}

BOOST_AUTO_TEST_CASE(no_points_and_one_point_have_no_height_of_nan)
{
  const Sparse_ground_options rules;
  Scan scan;
  const Sparse_ground nothing(scan, 1.3, rules, {});
  BOOST_TEST(!nothing.is_found());
  scan.points.emplace_back(1, 2, 3);
  const Sparse_ground one(scan, 1.3, rules, {1});
  BOOST_TEST(std::abs(one.height(Vec3(1, 2, 4)) - 1) < 1e-6);
}

BOOST_AUTO_TEST_CASE(a_tiny_breast_height_keeps_points_apart)
{
  const Sparse_ground_options rules;
  Scan scan;
  for (int i = 0; i < 5; ++i)
    scan.points.emplace_back(i, -2 * i, 0.1 * i);
  for (const double breast_height : {1e-19, 1e-30, 1e-300}) {
    const Sparse_ground ground(scan, breast_height, rules, {1, 1, 1, 1, 1});
    for (const Vec3& p : scan.points)
      BOOST_TEST(std::abs(ground.height(p)) < 1e-9, breast_height << ": " << ground.height(p));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Sparse_ground
