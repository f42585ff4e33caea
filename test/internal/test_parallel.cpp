// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Loops, sums and sorting give bit-identical results for every number of threads.

#include <pcs/internal/parallel.h>
#include <pcs/internal/thread_tasks.h>
#include <support/point_clouds.h>
#include <support/threads.h>

#include <boost/mpl/list.hpp>
#include <boost/test/unit_test.hpp>

#include <atomic>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace test_parallel {

namespace {

using Any_tag = CGAL::Parallel_if_available_tag;
#if PCS_HAS_TBB
using Tags = boost::mpl::list<CGAL::Sequential_tag, Any_tag>;
#else
using Tags = boost::mpl::list<CGAL::Sequential_tag>; // both tags are equal
#endif
namespace internal = pcs::internal;

std::vector<double> wild_numbers(std::size_t n)
{
  std::mt19937 random(1);
  std::vector<double> numbers(n);
  for (double& x : numbers)
    x = std::ldexp(pcs_test::uniform(random), static_cast<int>(random() % 60) - 30);
  return numbers;
}

template <class Tag>
double sum(const std::vector<double>& numbers)
{
  return internal::blocked_reduce<Tag>(
      numbers.size(),
      0.0,
      [&](std::size_t i) { return numbers[i]; },
      std::plus<double>());
}

} // namespace

BOOST_AUTO_TEST_SUITE(parallel)

BOOST_AUTO_TEST_CASE_TEMPLATE(every_index_is_visited_once, Tag, Tags)
{
  for (const std::size_t n : {0u, 1u, 1023u, 1024u, 1025u, 2048u, 100000u}) {
    std::vector<std::atomic<int>> visits(n);
    internal::for_each_index<Tag>(n, [&](std::size_t i) { ++visits[i]; });
    std::size_t once = 0;
    for (const auto& v : visits)
      once += v == 1 ? 1 : 0;
    BOOST_TEST(once == n);
  }
}

BOOST_AUTO_TEST_CASE_TEMPLATE(blocks_are_consecutive_and_never_empty, Tag, Tags)
{
  for (const std::size_t block : {1u, 7u, 1000u, 5000u}) {
    std::vector<std::atomic<std::size_t>> end_of_block((1000 + block - 1) / block);
    internal::for_each_block<Tag>(1000, block, [&](std::size_t begin, std::size_t end) {
      end_of_block[begin / block] = begin % block == 0 && begin < end ? end : 0;
    });
    for (std::size_t b = 0; b < end_of_block.size(); ++b)
      BOOST_TEST(end_of_block[b] == std::min<std::size_t>(1000, (b + 1) * block));
  }
}

BOOST_AUTO_TEST_CASE(sums_have_the_same_bits_for_every_number_of_threads)
{
  const auto numbers = wild_numbers(123457);
  const double sequential = sum<CGAL::Sequential_tag>(numbers);
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      for (int repetition = 0; repetition < 5; ++repetition)
        BOOST_TEST(sum<Any_tag>(numbers) == sequential);
    });
}

BOOST_AUTO_TEST_CASE_TEMPLATE(values_are_joined_in_the_order_of_their_indices, Tag, Tags)
{
  const auto text = internal::blocked_reduce<Tag>(
      26,
      std::string(),
      [](std::size_t i) { return std::string(1, static_cast<char>('a' + i)); },
      std::plus<std::string>(),
      4);
  BOOST_TEST(text == "abcdefghijklmnopqrstuvwxyz");
}

BOOST_AUTO_TEST_CASE_TEMPLATE(sum_of_nothing_is_the_initial_value, Tag, Tags)
{
  BOOST_TEST(sum<Tag>({}) == 0);
}

BOOST_AUTO_TEST_CASE(sorting_gives_the_same_order_for_every_number_of_threads)
{
  std::mt19937 random(3);
  std::vector<std::pair<int, int>> values;
  for (int i = 0; i < 50000; ++i)
    values.emplace_back(static_cast<int>(random() % 100), i);
  std::shuffle(values.begin(), values.end(), random);
  auto expected = values;
  std::sort(expected.begin(), expected.end());
  for (const int threads : pcs_test::thread_counts)
    pcs_test::with_threads(threads, [&] {
      auto sorted = values;
      internal::sort<Any_tag>(sorted.begin(), sorted.end(), std::less<>());
      BOOST_TEST((sorted == expected));
    });
}

BOOST_AUTO_TEST_CASE_TEMPLATE(both_pieces_of_work_are_done, Tag, Tags)
{
  int a = 0, b = 0;
  internal::invoke_both<Tag>([&] { a = 1; }, [&] { b = 2; });
  BOOST_TEST(a == 1);
  BOOST_TEST(b == 2);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(a_waiting_thread_calls_again_and_again, Tag, Tags)
{
  const auto caller = std::this_thread::get_id();
  std::atomic<int> calls{0};
  std::thread::id of_first, of_second;
  internal::invoke_both<Tag>([&] { of_first = std::this_thread::get_id(); },
                             [&] {
                               of_second = std::this_thread::get_id();
                               // if this is another thread, the caller waits
                               while (of_second != caller && calls < 3)
                                 std::this_thread::yield();
                             },
                             [&] {
                               BOOST_TEST((std::this_thread::get_id() == caller));
                               ++calls;
                             });
  BOOST_TEST((of_first == caller));
  BOOST_TEST((of_second == caller || calls >= 3));
}

BOOST_AUTO_TEST_CASE_TEMPLATE(an_exception_leaves_after_both_pieces_of_work, Tag, Tags)
{
  const auto fail = [] { throw std::range_error("stop"); };
  const auto nothing = [] {};
  BOOST_CHECK_THROW(internal::invoke_both<Tag>(fail, nothing, nothing), std::range_error);
  BOOST_CHECK_THROW(internal::invoke_both<Tag>(nothing, fail, nothing), std::range_error);
  if (!internal::is_parallel<Tag>())
    return;
  for (int k = 0; k < 20; ++k) {
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> is_released{false}, is_elsewhere{false}, has_ended{false};
    const auto wait = [&] {
      is_elsewhere = std::this_thread::get_id() != caller;
      while (is_elsewhere && !is_released)
        std::this_thread::yield();
      has_ended = true;
    };
    const auto release_and_fail = [&] {
      is_released = true;
      throw std::range_error("stop");
    };
    try {
      internal::invoke_both<Tag>(nothing, wait, release_and_fail);
      BOOST_TEST(!is_elsewhere);
    } catch (const std::range_error&) {
      BOOST_TEST(is_elsewhere);
    }
    BOOST_TEST(has_ended);
  }
}

BOOST_AUTO_TEST_CASE_TEMPLATE(long_tasks_with_loops_of_their_own_are_done_once, Tag, Tags)
{
  const auto caller = std::this_thread::get_id();
  for (std::size_t n = 0; n < 6; ++n) {
    std::vector<std::atomic<int>> visits(n);
    std::vector<double> sums(n, 0);
    internal::for_each_long_task<Tag>(
        n,
        [&](std::size_t k) {
          ++visits[k];
          sums[k] = sum<Tag>(std::vector<double>(5000, double(k)));
        },
        [&] { BOOST_TEST((std::this_thread::get_id() == caller)); });
    for (std::size_t k = 0; k < n; ++k) {
      BOOST_TEST(visits[k] == 1);
      BOOST_TEST(sums[k] == 5000.0 * double(k));
    }
  }
}

BOOST_AUTO_TEST_CASE_TEMPLATE(no_long_task_begins_after_an_exception, Tag, Tags)
{
  std::atomic<int> ended{0};
  const auto fail = [&](std::size_t k) {
    if (k == 0)
      throw std::range_error("stop");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ++ended;
  };
  BOOST_CHECK_THROW(internal::for_each_long_task<Tag>(1000, fail, [] {}), std::range_error);
  BOOST_TEST(ended < 900);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(a_loop_in_slices_visits_every_block_once_until_it_is_stopped,
                              Tag,
                              Tags)
{
  constexpr std::size_t n = 1003, block = 10, blocks_per_slice = 4;
  for (const double stop : {2.0, 0.5, 0.0}) {
    std::vector<int> visits(n, 0);
    const bool is_complete = internal::for_each_block_while<Tag>(
        n,
        block,
        blocks_per_slice,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            ++visits[i];
        },
        [&](double f) { return f < stop; });
    BOOST_TEST(is_complete == (stop > 1));
    const std::size_t end = stop > 1 ? n : stop > 0 ? 520u : 0u; // the first multiple of 40
    for (std::size_t i = 0; i < n; ++i)
      BOOST_TEST(visits[i] == (i < end ? 1 : 0));
  }
}

BOOST_AUTO_TEST_CASE_TEMPLATE(an_exception_in_a_loop_reaches_the_caller, Tag, Tags)
{
  BOOST_CHECK_THROW(internal::for_each_index<Tag>(10000,
                                                  [](std::size_t i) {
                                                    if (i == 7777)
                                                      throw std::range_error("stop");
                                                  }),
                    std::range_error);
}

// Replacement of oneTBB under the thread sanitizer.
BOOST_AUTO_TEST_CASE(tasks_run_in_two_threads_and_end_before_an_exception_leaves)
{
  for (const std::size_t n : {0u, 1u, 2u, 7u}) {
    std::vector<int> visits(n);
    std::vector<std::thread::id> thread(n);
    internal::run_tasks_in_two_threads(n, [&](std::size_t i) {
      ++visits[i];
      thread[i] = std::this_thread::get_id();
    });
    for (std::size_t i = 0; i < n; ++i) {
      BOOST_TEST(visits[i] == 1);
      BOOST_TEST((thread[i] == std::this_thread::get_id()) == (i % 2 == 0));
    }
  }
  for (const bool is_first : {true, false}) {
    bool has_ended = false;
    const auto stop = [] { throw std::range_error("stop"); };
    const auto end = [&] { has_ended = true; };
    if (is_first)
      BOOST_CHECK_THROW(internal::run_in_two_threads(stop, end), std::range_error);
    else
      BOOST_CHECK_THROW(internal::run_in_two_threads(end, stop), std::range_error);
    BOOST_TEST(has_ended);
  }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_parallel
