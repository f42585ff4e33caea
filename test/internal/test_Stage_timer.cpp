// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A stage adds its seconds at its end, unless they are discarded.

#include <pcs/internal/Stage_timer.h>

#include <boost/test/unit_test.hpp>

namespace test_Stage_timer {

BOOST_AUTO_TEST_SUITE(stage_seconds)

BOOST_AUTO_TEST_CASE(seconds_are_added)
{
  double seconds = 2;
  {
    const pcs::internal::Stage_timer timer(seconds);
    BOOST_TEST(seconds == 2);
  }
  BOOST_TEST(seconds >= 2);
}

BOOST_AUTO_TEST_CASE(discarded_seconds_are_not_added)
{
  double seconds = 2;
  {
    pcs::internal::Stage_timer timer(seconds);
    timer.discard();
  }
  BOOST_TEST(seconds == 2);
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Stage_timer
