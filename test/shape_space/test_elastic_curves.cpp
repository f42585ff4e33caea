// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Elastic matching of curves whose correspondence is known.

#include <pcs/shape_space/elastic_curves.h>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace test_elastic_curves {

using namespace pcs::shape_space;

namespace {

/// A curve with tangents turning by `bend(t)` in a plane, t being the share of its length.
template <class Bend>
Sampled_curve make_curve(std::size_t n, double length, const Bend& bend)
{
  Sampled_curve curve;
  curve.length = length;
  curve.tangents.resize(3, static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = bend(static_cast<double>(i) / static_cast<double>(n - 1));
    curve.tangents.col(static_cast<Eigen::Index>(i)) = Vec3(std::cos(angle), std::sin(angle), 0);
  }
  return curve;
}

double energy(Elastic_matcher& matcher, const Sampled_curve& a, const Sampled_curve& b)
{
  return a.length + b.length -
         2 * std::sqrt(a.length * b.length) * matcher(a, b, Eigen::Matrix3d::Identity());
}

} // namespace

BOOST_AUTO_TEST_SUITE(elastic_curves)

BOOST_AUTO_TEST_CASE(straight_curves_cost_what_their_lengths_say)
{
  Elastic_matcher matcher(33, 3);
  const auto straight = [](double) { return 0.3; };
  const auto a = make_curve(33, 4, straight), b = make_curve(33, 1, straight);
  BOOST_TEST(std::abs(energy(matcher, a, b) - 1) < 1e-12); // (sqrt 4 - sqrt 1)^2
  BOOST_TEST(std::abs(energy(matcher, a, a)) < 1e-12);
}

BOOST_AUTO_TEST_CASE(the_energy_stays_between_its_bounds)
{
  Elastic_matcher matcher(33, 3);
  for (int k = 0; k < 20; ++k) {
    const auto a = make_curve(33, 1 + k, [&](double t) { return 3 * std::sin(k * t); });
    const auto b = make_curve(33, 2, [&](double t) { return 2 * t * k; });
    const double e = energy(matcher, a, b);
    BOOST_TEST(e >= std::pow(std::sqrt(a.length) - std::sqrt(b.length), 2) - 1e-12);
    BOOST_TEST(e <= a.length + b.length + 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(a_known_warp_is_found)
{
  // the bends of curve 2 come later: place t of curve 1 is at t^1.5 or so of curve 2
  const auto warp = [](double t) { return 0.5 * t + 0.5 * t * t; };
  const auto bend = [](double t) { return 2.5 * std::sin(4 * t); };
  const std::size_t n = 65;
  const auto two = make_curve(n, 3, bend);
  const auto one = make_curve(n, 3, [&](double t) { return bend(warp(t)); });
  Elastic_matcher matcher(n, 6);
  matcher(one, two, Eigen::Matrix3d::Identity());
  const std::vector<double> gamma = matcher.gamma();
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n - 1);
    worst = std::max(worst, std::abs(gamma[i] - warp(t)));
    BOOST_TEST(std::abs(inverse_at(gamma, value_at(gamma, t)) - t) < 1e-9);
  }
  BOOST_TEST(worst < 0.03);
  BOOST_TEST(gamma.front() == 0);
  BOOST_TEST(gamma.back() == 1);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_elastic_curves
