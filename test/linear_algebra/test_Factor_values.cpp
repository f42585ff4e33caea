// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Entries of factors keep the accuracy of their size.

#include <pcs/linear_algebra/Factor_values.h>
#include <support/point_clouds.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <random>
#include <vector>

namespace test_Factor_values {

using Values = pcs::linear_algebra::Factor_values;
using pcs::linear_algebra::Value_size;

namespace {

std::vector<double> stored(const std::vector<double>& values, Value_size size)
{
  Values factor;
  BOOST_REQUIRE(factor.resize(values.size(), size, {}));
  BOOST_REQUIRE(factor.size() == values.size());
  factor.set(0, values.data(), values.size());
  std::vector<double> result;
  factor.visit([&](const auto& all) {
    for (std::size_t i = 0; i < values.size(); ++i)
      result.push_back(all.column(i / 2)[i - i / 2]);
  });
  return result;
}

/// Values in [-1, 0] of all magnitudes down to 2^-exponent.
std::vector<double> values_down_to(int exponent)
{
  std::mt19937 random(5);
  std::vector<double> values = {-1, -0.5, -std::exp2(-exponent), std::nextafter(-1.0, 0.0)};
  for (int k = 0; k < 10000; ++k)
    values.push_back(-std::exp2(-exponent * std::abs(pcs_test::uniform(random))));
  return values;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Factor_values)

BOOST_AUTO_TEST_CASE(relative_errors_are_those_of_the_size)
{
  const std::vector<double> any = {3, -1e300, 0, 1e-300};
  BOOST_TEST(stored(any, Value_size::eight) == any, boost::test_tools::per_element());
  for (const bool is_six : {true, false}) {
    const std::vector<double> values = values_down_to(is_six ? 63 : 31);
    const auto result = stored(values, is_six ? Value_size::six : Value_size::three);
    BOOST_TEST(result[0] == -1);
    BOOST_TEST(result[1] == -0.5);
    BOOST_TEST(result[2] == values[2]);
    double largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      largest = std::max(largest, std::abs(result[i] / values[i] - 1));
    BOOST_TEST(largest <= std::exp2(is_six ? -43 : -20));
    BOOST_TEST(largest > std::exp2(is_six ? -45 : -22));
  }
}

BOOST_AUTO_TEST_CASE(smaller_entries_become_the_smallest)
{
  const std::vector<double> tiny = {0, -0.0, -1e-30, -1e-300};
  for (const double x : stored(tiny, Value_size::six))
    BOOST_TEST(x == -std::exp2(-63));
  for (const double x : stored(tiny, Value_size::three))
    BOOST_TEST(x == -std::exp2(-31));
}

BOOST_AUTO_TEST_CASE(no_memory_is_provided_after_a_stop)
{
  Values factor;
  BOOST_TEST(!factor.resize(100, Value_size::six, [](double) { return false; }));
  BOOST_TEST(factor.resize(100, Value_size::three, [](double) { return true; }));
  BOOST_TEST(factor.size() == 100u);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Factor_values
