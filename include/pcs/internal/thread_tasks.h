// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tasks in plain threads for the thread sanitizer, which cannot see how oneTBB orders tasks.

#ifndef PCS_INTERNAL_THREAD_TASKS_H
#define PCS_INTERNAL_THREAD_TASKS_H

#include <cstddef>
#include <exception>
#include <thread>

namespace pcs {
namespace internal {

/// Runs two tasks concurrently. An exception is rethrown after both have ended.
template <class F, class G>
void run_in_two_threads(const F& f, const G& g)
{
  std::exception_ptr errors[2];
  const auto guarded = [&errors](const auto& task, std::size_t which) {
    try {
      task();
    } catch (...) {
      errors[which] = std::current_exception();
    }
  };
  std::thread other([&] { guarded(g, 1); });
  guarded(f, 0);
  other.join();
  for (const std::exception_ptr& error : errors)
    if (error)
      std::rethrow_exception(error);
}

/// Calls `f(i)` for `i` in `[0, n)`. Adjacent indices run in different threads, so that data races
/// between them can be detected.
template <class F>
void run_tasks_in_two_threads(std::size_t n, const F& f)
{
  const auto every_other = [&](std::size_t first) {
    for (std::size_t i = first; i < n; i += 2)
      f(i);
  };
  run_in_two_threads([&] { every_other(0); }, [&] { every_other(1); });
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_THREAD_TASKS_H
