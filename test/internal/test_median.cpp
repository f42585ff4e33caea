// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Medians by selection are equal to those of sorted values.

#include <pcs/internal/Random_stream.h>
#include <pcs/internal/median.h>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace test_median {

namespace {

/// Medians of a copy of the values.
double lower(std::vector<double> values)
{
  return pcs::internal::lower_median(values);
}
double upper(std::vector<double> values)
{
  return pcs::internal::upper_median(values);
}
double mean(std::vector<double> values)
{
  return pcs::internal::mean_median(values);
}

/// `n` values in [0, 4), rounded to quarters, so that some are equal.
std::vector<double> random_values(std::size_t n)
{
  pcs::internal::Random_stream random(7, n);
  std::vector<double> values(n);
  for (double& v : values)
    v = std::floor(random.uniform(0, 16)) / 4;
  return values;
}

} // namespace

BOOST_AUTO_TEST_SUITE(median)

BOOST_AUTO_TEST_CASE(an_odd_number_of_values_has_one_median)
{
  const std::vector<double> values{5, -1, 3};
  BOOST_TEST(lower(values) == 3);
  BOOST_TEST(upper(values) == 3);
  BOOST_TEST(mean(values) == 3);
}

BOOST_AUTO_TEST_CASE(an_even_number_of_values_has_two_and_their_mean)
{
  const std::vector<double> values{8, 1, 4, 2};
  BOOST_TEST(lower(values) == 2);
  BOOST_TEST(upper(values) == 4);
  BOOST_TEST(mean(values) == 3);
}

BOOST_AUTO_TEST_CASE(the_median_of_no_values_is_0)
{
  BOOST_TEST(lower({}) == 0);
  BOOST_TEST(upper({}) == 0);
  BOOST_TEST(mean({}) == 0);
}

BOOST_AUTO_TEST_CASE(one_value_is_its_median)
{
  BOOST_TEST(lower({2.5}) == 2.5);
  BOOST_TEST(upper({2.5}) == 2.5);
  BOOST_TEST(mean({2.5}) == 2.5);
}

BOOST_AUTO_TEST_CASE(all_ranks_are_those_of_the_sorted_values)
{
  for (std::size_t n = 1; n < 40; ++n) {
    std::vector<double> values = random_values(n), sorted = values;
    std::sort(sorted.begin(), sorted.end());
    BOOST_TEST(lower(values) == sorted[(n - 1) / 2]);
    BOOST_TEST(upper(values) == sorted[n / 2]);
    BOOST_TEST(mean(values) == 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]));
    for (std::size_t rank = 0; rank < n; ++rank)
      BOOST_TEST(pcs::internal::value_of_rank(values, rank) == sorted[rank]);
  }
}

BOOST_AUTO_TEST_CASE(a_part_of_a_range_has_its_own_median)
{
  std::array<float, 5> values{3, 1, 2, 9, 8};
  BOOST_TEST(pcs::internal::upper_median(values.begin(), values.begin() + 3) == 2.0F);
  BOOST_TEST(pcs::internal::upper_median(values.begin(), values.begin()) == 0.0F);
  BOOST_TEST(values[3] == 9.0F);
  BOOST_TEST(values[4] == 8.0F);
}

BOOST_AUTO_TEST_CASE(no_value_is_lost)
{
  std::vector<double> values = random_values(20);
  const std::vector<double> before = values;
  pcs::internal::mean_median(values);
  BOOST_TEST(std::is_permutation(values.begin(), values.end(), before.begin()));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_median
