// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Fit of an axis: wrong initial axes, thin twigs, one-sided points, bounds of radii.

#include <pcs/skeleton/axes/Axis_fit.h>
#include <support/sections.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_Axis_fit {

using pcs::skeleton::Vec3;
using pcs_test::tube;
constexpr double pi = 3.14159265358979323846;

BOOST_AUTO_TEST_SUITE(Axis_fit)

BOOST_AUTO_TEST_CASE(a_wrong_start_finds_the_axis_of_half_a_tube)
{
  std::vector<Vec3> points;
  for (const Vec3& p : tube(0.1, 1, 4000))
    if (p.x() > 0)
      points.push_back(p);
  pcs::skeleton::Axis axis;
  for (int k = 0; k <= 10; ++k) {
    pcs::skeleton::Axis_node node;
    node.point = Vec3(0.04, 0.01, 0.1 * k);
    node.radius = 0.08;
    axis.push_back(node);
  }
  pcs::skeleton::Axis_fit fit(axis, pcs::skeleton::Fit_model::of(0.01, 0.002));
  fit.set_points(points, std::vector<pcs::skeleton::Index>(points.size(), 0));
  fit.project();
  for (int k = 0; k < 12; ++k)
    BOOST_REQUIRE(fit.iterate(k < 6 ? 4 : 1));
  for (const auto& node : fit.axis()) {
    BOOST_CHECK_CLOSE(node.radius, 0.1, 2.0);
    BOOST_CHECK_SMALL(std::hypot(node.point.x(), node.point.y()), 0.002);
  }
}

// Seven points of a twig that is much thinner than the noise. Without the curvature of the
// distances, the steps oscillate between the sides of the points.
BOOST_AUTO_TEST_CASE(fits_of_thin_twigs_settle)
{
  constexpr double noise = 0.003;
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, noise);
  for (int repetition = 0; repetition < 50; ++repetition) {
    std::vector<Vec3> points;
    for (int i = 0; i < 7; ++i) {
      const double x = normal(random), y = normal(random);
      points.emplace_back(x, y, 0.02 + 0.01 * i);
    }
    pcs::skeleton::Axis axis(11);
    for (std::size_t k = 0; k < axis.size(); ++k) {
      axis[k].point = Vec3(0, 0, 0.01 * double(k));
      axis[k].radius = 0.001;
    }
    pcs::skeleton::Axis_fit fit(axis, pcs::skeleton::Fit_model::of(0.01, noise));
    fit.set_points(points, std::vector<pcs::skeleton::Index>(points.size(), 3));
    fit.set_priors(std::vector<pcs::skeleton::Radius_prior>(axis.size(), {1e-4, 1e-3}));
    fit.project();
    for (int k = 0; k < 15; ++k)
      BOOST_REQUIRE(fit.iterate(1));
    BOOST_CHECK_LT(fit.largest_change(), 0.3 * noise);
  }
}

// The front of a twig. An axis in the middle of its points remains there unless the fit has the
// side on which the points lie.
BOOST_AUTO_TEST_CASE(the_side_of_the_points_finds_the_axis_behind_them)
{
  namespace sk = pcs::skeleton;
  constexpr double radius = 0.004, noise = 0.003, facing = 0.25 * pi;
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Vec3> points;
  for (const Vec3& p : tube(radius, 0.3, 240))
    if (p.x() > 0)
      points.emplace_back(p.x() + normal(random), p.y(), p.z());
  const auto depth = [&](bool does_know) {
    sk::Axis axis(16);
    for (std::size_t k = 0; k < axis.size(); ++k) {
      axis[k].point = Vec3(facing * radius, 0, 0.02 * double(k));
      axis[k].radius = 0.003;
    }
    sk::Axis_fit fit(axis, sk::Fit_model::of(0.01, noise));
    fit.set_points(points, std::vector<sk::Index>(points.size(), 8));
    fit.set_priors(std::vector<sk::Radius_prior>(axis.size(), {radius, 0.5 * radius}));
    fit.project();
    for (int k = 0; k < 15; ++k) {
      std::vector<sk::Center_prior> priors;
      for (const sk::Axis_node& node : fit.axis())
        priors.push_back({Vec3(facing * radius, 0, node.point.z()), Vec3(facing, 0, 0), 0.002});
      if (does_know)
        fit.set_priors(priors);
      BOOST_REQUIRE(fit.iterate(1));
    }
    return fit.axis()[8].point.x();
  };
  BOOST_CHECK_GT(depth(false), 0.45 * radius);
  BOOST_CHECK_SMALL(depth(true), 0.35 * radius);
}

BOOST_AUTO_TEST_CASE(a_radius_at_its_lowest_value_does_not_change)
{
  constexpr double spacing = 0.1, noise = 0.003;
  pcs::skeleton::Axis axis(6);
  for (std::size_t k = 0; k < axis.size(); ++k) {
    axis[k].point = Vec3(0, 0, spacing * double(k));
    axis[k].radius = 0.01;
  }
  pcs::skeleton::Axis_fit fit(axis, pcs::skeleton::Fit_model::of(spacing, noise));
  const std::vector<Vec3> points = tube(1e-4, 0.5, 200); // thinner than the minimum radius of axes
  fit.set_points(points, std::vector<pcs::skeleton::Index>(points.size(), 0));
  fit.project();
  for (int k = 0; k < 10; ++k)
    BOOST_REQUIRE(fit.iterate(1));
  BOOST_CHECK_CLOSE(fit.axis()[2].radius, 0.05 * spacing, 1e-9);
  BOOST_CHECK_LT(fit.largest_change(), 0.01 * noise);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Axis_fit
