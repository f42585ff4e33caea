// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Growth splines: monotone values, constant rates, directions of branches that do not exist yet.

#include <pcs/core/rotations.h>
#include <pcs/shape_space/path/Growth_spline.h>
#include <support/layouts.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace test_Growth_spline {

using namespace pcs::shape_space;

namespace {

/// A trunk of one edge, and a branch of one edge on it.
const Orl_layout layout = orl_test::layout_of({{none, 1, none}, {0, 1, 0}});

/// The trees of a growth series by the lengths of both edges.
std::vector<Orl_coordinates> trees_of(const std::vector<double>& trunk,
                                      const std::vector<double>& branch)
{
  std::vector<Orl_coordinates> result(trunk.size(), orl_test::upright_tree(layout));
  for (std::size_t i = 0; i < trunk.size(); ++i)
    result[i].length = {trunk[i], branch[i]};
  return result;
}

const std::vector<std::vector<char>> all_there(4, std::vector<char>(2, 1));

double length_at(const Growth_spline& spline, double time, std::size_t edge)
{
  Orl_coordinates x;
  spline.at(time, x);
  return x.length[edge];
}

} // namespace

BOOST_AUTO_TEST_SUITE(growth_splines)

BOOST_AUTO_TEST_CASE(slopes_are_weighted_harmonic_means)
{
  // Rises 1 and 3: 6 / (3 / 1 + 3 / 3). The ends: (3 * 1 - 3) / 2 and (3 * 3 - 1) / 2.
  const std::vector<double> slopes =
      pcs::shape_space::internal::monotone_slopes({0, 1, 2}, {0, 1, 4});
  BOOST_TEST(slopes[0] == 0);
  BOOST_TEST(std::abs(slopes[1] - 1.5) < 1e-12);
  BOOST_TEST(std::abs(slopes[2] - 4) < 1e-12);
  // An extremum has slope 0.
  BOOST_TEST(pcs::shape_space::internal::monotone_slopes({0, 1, 2}, {0, 1, 0.5})[1] == 0);
}

BOOST_AUTO_TEST_CASE(the_closest_rising_values_are_means_of_falling_ones)
{
  std::vector<double> values{3, 1, 2, 5, 4, 4, 6};
  pcs::shape_space::internal::make_rising(values);
  const std::vector<double> expected{2, 2, 2, 13. / 3, 13. / 3, 13. / 3, 6};
  for (std::size_t i = 0; i < values.size(); ++i)
    BOOST_TEST(std::abs(values[i] - expected[i]) < 1e-12);
}

BOOST_AUTO_TEST_CASE(constant_rates_are_reproduced)
{
  std::vector<Orl_coordinates> trees = trees_of({1, 2, 4, 4.5}, {0.2, 0.3, 0.5, 0.55});
  const std::vector<double> times{0, 1, 3, 3.5};
  const Vec3 rate(0.3, 0.1, -0.2); // [rad] per unit of time
  for (std::size_t i = 0; i < 4; ++i) {
    trees[i].orientation[1] = pcs::rotation_exp(times[i] * rate);
    trees[i].root = Vec3(times[i], 0, 0);
  }
  const Growth_spline spline(layout, times, trees, all_there, false);
  for (double t = 0; t <= 3.5; t += 0.125) {
    Orl_coordinates x;
    spline.at(t, x);
    BOOST_TEST(std::abs(x.length[0] - (1 + t)) < 1e-12);
    BOOST_TEST(std::abs(x.length[1] - (0.2 + 0.1 * t)) < 1e-12);
    BOOST_TEST(angle_between(x.orientation[1], pcs::rotation_exp(t * rate)) < 1e-9);
    BOOST_TEST((x.root - Vec3(t, 0, 0)).norm() < 1e-12);
  }
  BOOST_TEST(length_at(spline, -7, 0) == 1);
  BOOST_TEST(length_at(spline, 7, 0) == 4.5);
}

BOOST_AUTO_TEST_CASE(values_do_not_overshoot)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int repetition = 0; repetition < 100; ++repetition) {
    std::vector<double> lengths(4), times(4);
    for (std::size_t i = 0; i < 4; ++i) {
      lengths[i] = uniform(random) < 0.3 ? 0 : std::pow(uniform(random), 4);
      times[i] = double(i) + 0.9 * uniform(random);
    }
    const Growth_spline spline(layout, times, trees_of(lengths, lengths), all_there, false);
    for (std::size_t i = 0; i + 1 < 4; ++i) {
      double last = lengths[i];
      const double sign = lengths[i + 1] >= lengths[i] ? 1 : -1;
      for (int k = 1; k <= 20; ++k) {
        const double t = times[i] + k / 20. * (times[i + 1] - times[i]);
        const double length = length_at(spline, t, 0);
        BOOST_TEST(sign * (length - last) > -1e-12);
        last = length;
      }
      BOOST_TEST(std::abs(last - lengths[i + 1]) < 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(a_monotone_path_changes_falling_lengths_to_their_mean)
{
  const std::vector<Orl_coordinates> trees = trees_of({1, 3, 2, 5}, {1, 1, 1, 1});
  const Growth_spline free(layout, {0, 1, 2, 3}, trees, all_there, false);
  const Growth_spline rising(layout, {0, 1, 2, 3}, trees, all_there, true);
  BOOST_TEST(length_at(free, 1, 0) == 3);
  BOOST_TEST(length_at(rising, 1, 0) == 2.5);
  BOOST_TEST(length_at(rising, 1.4, 0) == 2.5);
  BOOST_TEST(length_at(rising, 2, 0) == 2.5);
}

BOOST_AUTO_TEST_CASE(a_branch_that_does_not_exist_yet_has_its_later_direction)
{
  std::vector<Orl_coordinates> trees = trees_of({1, 2, 3, 4}, {0, 0, 1, 2});
  for (std::size_t i = 0; i < 4; ++i) {
    trees[i].orientation[1] = pcs::rotation_exp(Vec3(i < 2 ? 2 : 0.5, 0, 0));
    trees[i].attachment[1] = i < 2 ? 0.1 : 0.7;
  }
  std::vector<std::vector<char>> has = all_there;
  has[0][1] = has[1][1] = 0;
  const Growth_spline spline(layout, {0, 1, 2, 3}, trees, has, false);
  for (const double t : {0., 0.5, 1.5, 2.5}) {
    Orl_coordinates x;
    spline.at(t, x);
    BOOST_TEST(angle_between(x.orientation[1], pcs::rotation_exp(Vec3(0.5, 0, 0))) < 1e-9);
    BOOST_TEST(std::abs(x.attachment[1] - 0.7) < 1e-12);
    BOOST_TEST((x.length[1] > 0) == (t > 1));
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Growth_spline
