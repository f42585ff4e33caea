// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Progress never decreases, and a request to stop is kept.

#include <pcs/internal/progress.h>

#include <boost/test/unit_test.hpp>

#include <limits>
#include <stdexcept>
#include <thread>
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

BOOST_AUTO_TEST_CASE(other_threads_learn_the_last_answer_without_calls)
{
  int calls = 0;
  pcs::internal::Progress progress([&](double) { return ++calls < 2; });
  pcs::internal::Shared_progress shared(progress);
  const auto in_other_thread = [&] {
    bool goes_on = false;
    std::thread([&] { goes_on = shared(0.5); }).join();
    return goes_on;
  };
  BOOST_TEST(shared(0.1));
  BOOST_TEST(in_other_thread());
  BOOST_TEST(calls == 1);
  BOOST_TEST(!shared(0.2));
  BOOST_TEST(!in_other_thread());
  BOOST_TEST(!shared(0.3));
  BOOST_TEST(calls == 2);
}

BOOST_AUTO_TEST_CASE(other_threads_stop_if_the_callback_throws)
{
  pcs::internal::Progress progress([](double) -> bool { throw std::range_error("enough"); });
  pcs::internal::Shared_progress shared(progress);
  BOOST_CHECK_THROW(shared(0.1), std::range_error);
  bool goes_on = true;
  std::thread([&] { goes_on = shared(0.2); }).join();
  BOOST_TEST(!goes_on);
  BOOST_TEST(!shared(0.3)); // without another exception
}

BOOST_AUTO_TEST_CASE(parts_of_a_step_report_fractions_of_the_whole)
{
  using pcs::internal::Go_on;
  double last = -1;
  const Go_on whole = [&](double f) {
    last = f;
    return f < 0.7;
  };
  const Go_on half = pcs::internal::part_of(whole, 0.5, 1);
  const Go_on quarter = pcs::internal::part_of(half, 0, 0.5);
  BOOST_TEST(quarter(0.5));
  BOOST_TEST(last == 0.625);
  BOOST_TEST(!quarter(1));
  BOOST_TEST(pcs::internal::goes_on(quarter, 0.25));
  BOOST_TEST(!pcs::internal::goes_on(quarter, 1));
  BOOST_TEST(!pcs::internal::part_of(Go_on(), 0, 1));
  BOOST_TEST(pcs::internal::goes_on(Go_on(), 1));
}

BOOST_AUTO_TEST_CASE(without_callback_nothing_stops)
{
  pcs::internal::Progress progress;
  BOOST_TEST(progress(0.5));
  BOOST_TEST(!progress.is_cancelled());
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_progress
