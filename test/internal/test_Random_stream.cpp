// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of seeded random numbers.

#include <pcs/internal/Random_stream.h>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace test_Random_stream {

using pcs::internal::Random_stream;

BOOST_AUTO_TEST_SUITE(Random_stream_numbers)

BOOST_AUTO_TEST_CASE(the_bits_are_those_of_splitmix64)
{
  // The first outputs for the state 0, as published with the algorithm.
  BOOST_TEST(pcs::internal::mix_bits(0) == 0xe220a8397b1dcdafu);
  BOOST_TEST(pcs::internal::mix_bits(0x9e3779b97f4a7c15u) == 0x6e789e6aa1b965f4u);
}

BOOST_AUTO_TEST_CASE(seeds_and_keys_give_streams_of_their_own)
{
  BOOST_TEST(Random_stream(1).bits() == Random_stream(1).bits());
  BOOST_TEST(Random_stream(1).bits() != Random_stream(2).bits());
  BOOST_TEST(Random_stream(1, 2).bits() != Random_stream(1, 3).bits());
  BOOST_TEST(Random_stream(1, 2, 3).bits() != Random_stream(1, 3, 2).bits());
}

BOOST_AUTO_TEST_CASE(mean_and_variance_are_right)
{
  Random_stream random(7);
  constexpr int n = 200000;
  double sum = 0, square = 0, normal = 0, normal_square = 0, lag = 0, last = 0.5;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform(), z = random.normal();
    BOOST_REQUIRE(u >= 0 && u < 1 && std::isfinite(z));
    sum += u;
    square += u * u;
    normal += z;
    normal_square += z * z;
    lag += (u - 0.5) * (last - 0.5);
    last = u;
  }
  // five standard errors
  BOOST_TEST(std::abs(sum / n - 0.5) < 5 * std::sqrt(1.0 / 12 / n));
  BOOST_TEST(std::abs(square / n - 1.0 / 3) < 5 * std::sqrt(4.0 / 45 / n));
  BOOST_TEST(std::abs(normal / n) < 5 * std::sqrt(1.0 / n));
  BOOST_TEST(std::abs(normal_square / n - 1) < 5 * std::sqrt(2.0 / n));
  BOOST_TEST(std::abs(lag / n) < 5.0 / 12 / std::sqrt(n));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Random_stream
