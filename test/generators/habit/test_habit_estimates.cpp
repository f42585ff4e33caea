// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of the estimators of a habit on samples of known distribution.

#include <pcs/generators/habit/fit_branching.h>
#include <pcs/generators/habit/fit_profiles.h>
#include <pcs/generators/habit/fit_range.h>
#include <pcs/generators/habit/minimise.h>
#include <pcs/internal/Random_stream.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_habit_estimates {

namespace habit = pcs::generators::habit;
using pcs::internal::Random_stream;

BOOST_AUTO_TEST_SUITE(habit_estimates)

BOOST_AUTO_TEST_CASE(a_minimum_is_found)
{
  const auto f = [](const std::array<double, 2>& p) {
    return std::pow(1 - p[0], 2) + 10 * std::pow(p[1] - p[0] * p[0], 2);
  };
  const auto best = habit::minimise<2>(f, {-1, 1}, {0.5, 0.5}, 200);
  BOOST_TEST(std::abs(best[0] - 1) < 1e-3);
  BOOST_TEST(std::abs(best[1] - 1) < 1e-3);
}

BOOST_AUTO_TEST_CASE(errors_do_not_widen_a_range)
{
  Random_stream random(1);
  std::vector<habit::Range_sample> samples;
  for (int i = 0; i < 250; ++i)
    samples.push_back({random.uniform(2, 3) + 0.15 * random.normal(), 0.15});
  const auto range = habit::fit_range(samples);
  BOOST_TEST_REQUIRE(range.has_value());
  BOOST_TEST(std::abs(range->least - 2) < 0.08);
  BOOST_TEST(std::abs(range->largest - 3) < 0.08); // the largest sample is about 3.3
}

BOOST_AUTO_TEST_CASE(unseen_and_bounded_values_leave_no_bias)
{
  Random_stream random(2);
  std::vector<habit::Range_sample> samples;
  while (samples.size() < 250) {
    const double limit = random.uniform(1.5, 3), value = random.uniform(2, 3);
    const double bound = random.uniform(2, 3.5);
    if (value < limit)
      continue; // not seen
    const bool is_bounded = value > bound && bound > limit;
    samples.push_back({is_bounded ? bound : value, 0.02, limit, is_bounded});
  }
  const auto range = habit::fit_range(samples);
  BOOST_TEST_REQUIRE(range.has_value());
  BOOST_TEST(std::abs(range->least - 2) < 0.06);
  BOOST_TEST(std::abs(range->largest - 3) < 0.06);
}

BOOST_AUTO_TEST_CASE(a_limit_of_detection_does_not_narrow_a_range)
{
  // six of seven samples show nothing but the upper fifth of the range
  Random_stream random(6);
  std::vector<habit::Range_sample> samples;
  for (int i = 0; i < 250; ++i) {
    const double limit = i % 7 == 0 ? 0 : 2.8;
    samples.push_back({random.uniform(std::max(2.0, limit), 3), 0.02, limit});
  }
  const auto range = habit::fit_range(samples);
  BOOST_TEST_REQUIRE(range.has_value());
  BOOST_TEST(std::abs(range->least - 2) < 0.1);
  BOOST_TEST(std::abs(range->largest - 3) < 0.05);
}

BOOST_AUTO_TEST_CASE(single_outliers_do_not_widen_a_range)
{
  Random_stream random(3);
  std::vector<habit::Range_sample> samples = {{9, 0.02}, {0.1, 0.02}, {7, 0.02}};
  for (int i = 0; i < 150; ++i)
    samples.push_back({random.uniform(2, 3), 0.02});
  const auto range = habit::fit_range(samples);
  BOOST_TEST_REQUIRE(range.has_value());
  BOOST_TEST(std::abs(range->least - 2) < 0.06);
  BOOST_TEST(std::abs(range->largest - 3) < 0.06);
}

BOOST_AUTO_TEST_CASE(a_range_needs_four_samples)
{
  BOOST_TEST(!habit::fit_range({{1, 0.1}, {2, 0.1}, {3, 0.1}}).has_value());
  BOOST_TEST(habit::fit_range({{1, 0.1}, {1, 0.1}, {1, 0.1}, {1, 0.1}}).has_value());
}

BOOST_AUTO_TEST_CASE(the_blurred_uniform_is_a_distribution)
{
  const habit::Blurred_uniform u{2, 3, 0.2};
  double sum = 0;
  for (int i = 0; i < 3000; ++i)
    sum += u.density(1 + 0.001 * (i + 0.5)) * 0.001;
  BOOST_TEST(sum == 1, boost::test_tools::tolerance(1e-6));
  BOOST_TEST(u.share_above(2.5) == 0.5, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(u.share_above(0) == 1, boost::test_tools::tolerance(1e-9));
  BOOST_TEST((u.share_above(2.3) - u.share_above(2.301)) / 0.001 == u.density(2.3005),
             boost::test_tools::tolerance(1e-4));
}

BOOST_AUTO_TEST_CASE(quantiles_are_interpolated)
{
  BOOST_TEST(habit::quantile({3, 1, 2}, 0.5) == 2);
  BOOST_TEST(habit::quantile({1, 2}, 0.25) == 1.25);
  BOOST_TEST(std::isnan(habit::quantile({}, 0.5)));
}

BOOST_AUTO_TEST_CASE(taper_does_not_depend_on_the_error_of_a_branch)
{
  pcs::Tree_habit known;
  known.tip_radius = 0.002;
  habit::Tree_sample tree;
  Random_stream random(4);
  for (int b = 0; b < 12; ++b) {
    habit::Axis a;
    a.order = b == 0 ? 0 : 1;
    a.kind = b == 0 ? habit::Axis_kind::stem : habit::Axis_kind::branch;
    const double scale = std::exp(0.1 * random.normal());
    for (int i = 0; i <= 20; ++i) {
      const double x = i / 20.0;
      a.points.emplace_back(x, 0, b);
      a.at.push_back(x);
      a.radius.push_back(scale * 0.05 * (0.85 * std::pow(1 - x, 0.7) + 0.15));
    }
    tree.axes.push_back(a);
  }
  BOOST_TEST(habit::fit_branch_profiles({&tree}, known) == 11u);
  BOOST_TEST(known.taper[1] == 0.7, boost::test_tools::tolerance(0.002));
  BOOST_TEST(known.tip_share[1] == 0.15, boost::test_tools::tolerance(0.005));
}

BOOST_AUTO_TEST_CASE(whorls_are_clusters_of_places)
{
  Random_stream random(5);
  for (const std::size_t whorl : {std::size_t(1), std::size_t(3), std::size_t(5)}) {
    habit::Axis trunk;
    trunk.kind = habit::Axis_kind::stem;
    std::vector<habit::Axis> branches;
    for (int i = 0; i < 12; ++i) {
      const double at = 0.4 * i + 0.1 * random.uniform();
      for (std::size_t k = 0; k < whorl; ++k) {
        habit::Axis a;
        a.place_at = at + 0.01 * random.normal(); // measured
        branches.push_back(a);
      }
    }
    std::vector<habit::Child> children;
    for (const habit::Axis& a : branches)
      children.push_back({&a, &trunk, 0.02, 1});
    BOOST_TEST(habit::fit_whorl(children) == whorl);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_habit_estimates
