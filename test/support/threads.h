// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Runs a function on a given number of threads, to compare the results.

#ifndef PCS_TEST_SUPPORT_THREADS_H
#define PCS_TEST_SUPPORT_THREADS_H

#include <pcs/internal/parallel.h>

#if PCS_HAS_TBB
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#endif

#include <thread>

namespace pcs_test {

/// Without TBB, runs the function directly. More threads than cores are possible, since races also
/// occur then.
template <class Work>
void with_threads(int number_of_threads, const Work& work)
{
#if PCS_HAS_TBB
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                            static_cast<std::size_t>(number_of_threads));
  tbb::task_arena arena(number_of_threads);
  arena.execute(work);
#else
  static_cast<void>(number_of_threads);
  work();
#endif
}

/// Calls `work(0)` and `work(1)` at the same time, in two threads.
template <class Work>
void in_two_threads(const Work& work)
{
  std::thread other([&] { work(1); });
  work(0);
  other.join();
}

constexpr int thread_counts[] = {1, 2, 3, 8};

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_THREADS_H
