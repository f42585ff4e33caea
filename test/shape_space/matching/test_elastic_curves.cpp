// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Elastic matching of curves with known correspondence.

#include <pcs/shape_space/matching/elastic_curves.h>
#include <support/drawn.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <random>

namespace test_elastic_curves {

using namespace pcs::shape_space;

namespace {

/// A plane curve with tangents at the angle `bend(t)`, where t is the fraction of its length.
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

/// A space curve with random turns of its tangents.
Sampled_curve random_curve(std::mt19937& random, std::size_t n)
{
  std::normal_distribution<double> normal;
  const auto drawn = [&] { return pcs_test::drawn<Vec3>([&] { return normal(random); }); };
  Sampled_curve curve;
  curve.tangents.resize(3, static_cast<Eigen::Index>(n));
  Vec3 t = drawn();
  for (Eigen::Index i = 0; i < curve.tangents.cols(); ++i) {
    t = (t.normalized() + 0.3 * drawn()).normalized();
    curve.tangents.col(i) = t;
  }
  return curve;
}

/// Agreement of the tangents at node `i` of curve 1 and at `place`, in nodes, of curve 2.
double agreement(const Sampled_curve& one, const Eigen::Matrix3Xd& two, std::size_t i, double place)
{
  const auto j = std::min(two.cols() - 2, static_cast<Eigen::Index>(place));
  const double f = place - static_cast<double>(j);
  return one.tangents.col(static_cast<Eigen::Index>(i))
      .dot((1 - f) * two.col(j) + f * two.col(j + 1));
}

/// The largest M over all paths through the grid, by dynamic programming.
double largest_agreement(const Sampled_curve& one, const Eigen::Matrix3Xd& two, int largest_step)
{
  const auto n = static_cast<std::size_t>(two.cols());
  std::vector<std::vector<double>> best(
      n,
      std::vector<double>(n, -std::numeric_limits<double>::infinity()));
  best[0][0] = 0;
  for (std::size_t i = 1; i < n; ++i)
    for (std::size_t j = 1; j < n; ++j)
      for (const Slope& s : make_slopes(largest_step))
        if (s.a <= i && s.b <= j) {
          const double slope = static_cast<double>(s.b) / s.a;
          double value = best[i - s.a][j - s.b];
          for (std::size_t x = 0; x < s.a; ++x)
            value += std::sqrt(slope) *
                     agreement(one,
                               two,
                               i - s.a + x,
                               static_cast<double>(j - s.b) + slope * static_cast<double>(x));
          best[i][j] = std::max(best[i][j], value);
        }
  return std::max(0.0, best[n - 1][n - 1] / static_cast<double>(n - 1));
}

} // namespace

BOOST_AUTO_TEST_SUITE(elastic_curves)

BOOST_AUTO_TEST_CASE(no_path_through_the_grid_agrees_better)
{
  std::mt19937 random(1);
  for (const std::size_t n : {std::size_t(9), std::size_t(24), std::size_t(25)})
    for (const int largest_step : {3, 6})
      for (int repetition = 0; repetition < 5; ++repetition) {
        const Sampled_curve one = random_curve(random, n), two = random_curve(random, n);
        const Eigen::Matrix3d r =
            Eigen::AngleAxisd(repetition, Vec3(1, 2, 3).normalized()).toRotationMatrix();
        Elastic_matcher matcher(n, largest_step);
        const double found = matcher(one, two, r);
        const Eigen::Matrix3Xd turned = r * two.tangents;
        BOOST_TEST(std::abs(found - largest_agreement(one, turned, largest_step)) < 1e-8);
        // It is also the value of the correspondence.
        const std::vector<double> gamma = matcher.gamma();
        const double steps = static_cast<double>(n - 1);
        double along = 0;
        for (std::size_t i = 0; i + 1 < n; ++i)
          along += std::sqrt((gamma[i + 1] - gamma[i]) * steps) *
                   agreement(one, turned, i, gamma[i] * steps) / steps;
        if (found > 0)
          BOOST_TEST(std::abs(found - along) < 1e-8);
      }
}

BOOST_AUTO_TEST_CASE(rounding_does_not_choose_between_ways_that_agree_alike)
{
  // Along straight pieces, many paths are equal up to rounding, which a rotation of both curves
  // changes.
  const auto bent = [](double at) {
    return make_curve(25, 3, [at](double t) { return t < at ? 0.2 : 1.4; });
  };
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(-3, 3);
  for (const double at : {0.3, 0.45, 0.7}) {
    Sampled_curve one = bent(0.5), two = bent(at);
    Elastic_matcher matcher(25, 3);
    matcher(one, two, Eigen::Matrix3d::Identity());
    const std::vector<double> gamma = matcher.gamma();
    for (int repetition = 0; repetition < 40; ++repetition) {
      const Eigen::Matrix3d r = (Eigen::AngleAxisd(angle(random), Vec3::UnitX()) *
                                 Eigen::AngleAxisd(angle(random), Vec3(1, 1, 1).normalized()))
                                    .toRotationMatrix();
      one.tangents = r * one.tangents;
      two.tangents = r * two.tangents;
      matcher(one, two, Eigen::Matrix3d::Identity());
      BOOST_TEST(matcher.gamma() == gamma);
    }
  }
}

BOOST_AUTO_TEST_CASE(along_straight_pieces_the_plain_correspondence_is_kept)
{
  for (int k = 0; k < 20; ++k) {
    const auto straight = [&](double) { return 0.1 + 0.3 * k; };
    const auto a = make_curve(25, 4, straight), b = make_curve(25, 1, straight);
    Elastic_matcher matcher(25, 3);
    matcher(a, b, Eigen::AngleAxisd(0.07 * k, Vec3::UnitZ()).toRotationMatrix());
    const std::vector<double> gamma = matcher.gamma();
    for (std::size_t i = 0; i < gamma.size(); ++i)
      BOOST_TEST(std::abs(gamma[i] - static_cast<double>(i) / 24) < 1e-12);
  }
}

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
  // The bends of curve 2 are later: parameter t of curve 1 corresponds to about t^1.5 on curve 2.
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
