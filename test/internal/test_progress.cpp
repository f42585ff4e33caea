// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Progress never decreases, and a request to stop is kept.

#include <pcs/internal/progress.h>

#include <boost/test/unit_test.hpp>

#include <limits>
#include <vector>

namespace test_progress {

BOOST_AUTO_TEST_SUITE(progress)

BOOST_AUTO_TEST_CASE(values_never_decrease_and_stay_between_0_and_1)
{
  std::vector<double> seen;
  pcs::internal::Progress progress([&](double f) {
    seen.push_back(f);
    return true;
  });
  progress.stage(0, 0.5);
  for (const double f : {-1.0, 0.3, 0.2, 7.0, std::numeric_limits<double>::quiet_NaN()})
    BOOST_TEST(progress(f));
  progress.stage(0.25, 1);
  for (const double f : {0.0, 0.5, 1.0, 2.0})
    BOOST_TEST(progress(f));
  for (std::size_t i = 1; i < seen.size(); ++i)
    BOOST_TEST(seen[i] >= seen[i - 1]);
  BOOST_TEST(seen.front() == 0);
  BOOST_TEST(seen.back() == 1);
}

BOOST_AUTO_TEST_CASE(stages_share_the_range)
{
  double last = -1;
  pcs::internal::Progress progress([&](double f) {
    last = f;
    return true;
  });
  progress.stage(0.2, 0.6);
  progress(0.5);
  BOOST_TEST(last == 0.4, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(a_scoped_stage_ends_with_its_scope)
{
  double last = -1;
  pcs::internal::Progress progress([&](double f) {
    last = f;
    return true;
  });
  progress.stage(0, 0.5);
  {
    const pcs::internal::Progress_stage stage(progress, 0.125, 0.25);
    progress(1);
    BOOST_TEST(last == 0.25);
  }
  progress(1);
  BOOST_TEST(last == 0.5);
}

BOOST_AUTO_TEST_CASE(a_request_to_stop_is_remembered_and_ends_the_calls)
{
  int calls = 0;
  pcs::internal::Progress progress([&](double) { return ++calls < 3; });
  BOOST_TEST(progress(0.1));
  BOOST_TEST(!progress.is_cancelled());
  BOOST_TEST(progress(0.2));
  BOOST_TEST(!progress(0.3));
  BOOST_TEST(progress.is_cancelled());
  BOOST_TEST(!progress(0.4));
  BOOST_TEST(calls == 3);
}

BOOST_AUTO_TEST_CASE(without_callback_nothing_stops)
{
  pcs::internal::Progress progress;
  BOOST_TEST(progress(0.5));
  BOOST_TEST(!progress.is_cancelled());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_progress
