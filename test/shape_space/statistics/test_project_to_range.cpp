// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Angles and lengths of a tree are brought into the range of others.

#include <pcs/shape_space/statistics/project_to_range.h>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_project_to_range {

BOOST_AUTO_TEST_SUITE(ranges_of_trees)

BOOST_AUTO_TEST_CASE(moments_are_limited_by_the_least_change)
{
  pcs::shape_space::internal::Figure_range mean, deviation;
  mean.add(0.5);
  mean.add(0.6);
  deviation.add(0.1);
  deviation.add(0.2);
  std::vector<double> angles{0.2, 0.4, 0.6, 0.8}; // mean 0.5, deviation 0.2236
  pcs::shape_space::internal::limit_moments(mean, deviation, angles);
  const double factor = 0.2 / std::sqrt(0.05);
  for (std::size_t i = 0; i < 4; ++i)
    BOOST_TEST(std::abs(angles[i] - (0.5 + factor * (0.2 * static_cast<double>(i) - 0.3))) < 1e-12);
  const std::vector<double> inside = angles;
  pcs::shape_space::internal::limit_moments(mean, deviation, angles);
  for (std::size_t i = 0; i < 4; ++i)
    BOOST_TEST(std::abs(angles[i] - inside[i]) < 1e-12);
  std::vector<double> steep{-0.0, 0, 0, 3.0}; // the smallest values are limited to 0
  pcs::shape_space::internal::limit_moments(mean, deviation, steep);
  double m = 0;
  for (const double a : steep) {
    BOOST_TEST(a >= 0);
    m += a / 4;
  }
  BOOST_TEST(m > 0.5 - 1e-3);
  BOOST_TEST(m < 0.6 + 1e-3);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_project_to_range
