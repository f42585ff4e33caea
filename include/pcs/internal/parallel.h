// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Loops and sums over index ranges, sequential or by TBB, bit-identical for all thread counts.

#ifndef PCS_INTERNAL_PARALLEL_H
#define PCS_INTERNAL_PARALLEL_H

#include <CGAL/tags.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

// Without the CMake target, which defines PCS_WITH_TBB, the definition of CGAL applies.
#if !defined(PCS_WITH_TBB) && defined(CGAL_LINKED_WITH_TBB)
#define PCS_WITH_TBB 1
#endif

#if defined(PCS_WITH_TBB) && PCS_WITH_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#define PCS_HAS_TBB 1
#else
#define PCS_HAS_TBB 0
#endif

#if defined(__SANITIZE_THREAD__)
#define PCS_HAS_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PCS_HAS_THREAD_SANITIZER 1
#endif
#endif
#if defined(PCS_HAS_THREAD_SANITIZER)
#include <pcs/internal/thread_tasks.h>
#endif

namespace pcs {
namespace internal {

template <class ConcurrencyTag>
constexpr bool is_parallel()
{
  constexpr bool wants_parallel = std::is_convertible_v<ConcurrencyTag, CGAL::Parallel_tag>;
#if PCS_HAS_TBB
  return wants_parallel;
#else
  // Parallel_if_available_tag derives from Parallel_tag if and only if CGAL uses TBB. It must be
  // accepted here in any case.
  static_assert(!wants_parallel || !std::is_same_v<ConcurrencyTag, CGAL::Parallel_tag>,
                "pcs: CGAL::Parallel_tag needs TBB; link TBB (PCS_WITH_TBB) or use "
                "CGAL::Parallel_if_available_tag");
  return false;
#endif
}

/// Number of indices per task. It is fixed, so that no result depends on the number of threads.
constexpr std::size_t default_block = 1024;

/// A reference to a function of an index. Loops that take it are compiled once, not for each
/// function: the templates of TBB take long to compile.
class Index_function
{
public:
  template <class F>
  explicit Index_function(const F& f)
    : m_f(&f), m_call([](const void* g, std::size_t i) { (*static_cast<const F*>(g))(i); })
  {
  }
  void operator()(std::size_t i) const { m_call(m_f, i); }

private:
  const void* m_f;
  void (*m_call)(const void*, std::size_t);
};

#if PCS_HAS_TBB
/// Calls `f(i)` for every `i` in `[0, n)`, each on one of several threads.
inline void run_tasks(std::size_t n, const Index_function& f)
{
#if defined(PCS_HAS_THREAD_SANITIZER)
  run_tasks_in_two_threads(n, f);
#else
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n),
                    [&](const tbb::blocked_range<std::size_t>& r) {
                      for (std::size_t i = r.begin(); i != r.end(); ++i)
                        f(i);
                    });
#endif
}

/// Calls `f(0)` and `f(1)`, each on one of two threads.
inline void run_two_tasks(const Index_function& f)
{
#if defined(PCS_HAS_THREAD_SANITIZER)
  run_in_two_threads([&] { f(0); }, [&] { f(1); });
#else
  tbb::parallel_invoke([&] { f(0); }, [&] { f(1); });
#endif
}
#endif

/// Calls `f(begin, end)` for consecutive blocks of at most `block` indices that cover `[0, n)`.
template <class ConcurrencyTag, class F>
void for_each_block(std::size_t n, std::size_t block, const F& f)
{
  if constexpr (is_parallel<ConcurrencyTag>()) {
#if PCS_HAS_TBB
    if (n > block) {
      const std::size_t number_of_blocks = (n + block - 1) / block;
      const auto run = [&](std::size_t b) { f(b * block, std::min(n, (b + 1) * block)); };
      run_tasks(number_of_blocks, Index_function(run));
      return;
    }
#endif
  }
  for (std::size_t begin = 0; begin < n; begin += block)
    f(begin, std::min(n, begin + block));
}

/// The same, but asks `goes_on(fraction)` in the calling thread before each slice of
/// `blocks_per_slice` blocks. Returns `false` if the answer was `false`; the remaining blocks are
/// not processed.
template <class ConcurrencyTag, class F, class GoesOn>
bool for_each_block_while(std::size_t n,
                          std::size_t block,
                          std::size_t blocks_per_slice,
                          const F& f,
                          const GoesOn& goes_on)
{
  const std::size_t slice = block * blocks_per_slice;
  for (std::size_t from = 0; from < n; from += slice) {
    if (!goes_on(static_cast<double>(from) / static_cast<double>(n)))
      return false;
    for_each_block<ConcurrencyTag>(
        std::min(n - from, slice),
        block,
        [&](std::size_t begin, std::size_t end) { f(from + begin, from + end); });
  }
  return true;
}

/// Calls `f(i)` once for every `i` in `[0, n)`; `f(i)` may write only data that belong to `i`.
template <class ConcurrencyTag, class F>
void for_each_index(std::size_t n, const F& f, std::size_t block = default_block)
{
  for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i)
      f(i);
  });
}

/// Combines `value(i)` over `[0, n)`: sequentially inside blocks of fixed size, then block by block
/// in order. `partial` stores the results of the blocks, so that callers can reuse its memory.
template <class ConcurrencyTag, class T, class Value, class Join>
T blocked_reduce(std::size_t n,
                 T init,
                 const Value& value,
                 const Join& join,
                 std::size_t block,
                 std::vector<T>& partial)
{
  partial.assign((n + block - 1) / block, init);
  for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    T sum = init;
    for (std::size_t i = begin; i != end; ++i)
      sum = join(sum, value(i));
    partial[begin / block] = sum;
  });
  T total = init;
  for (const T& p : partial)
    total = join(total, p);
  return total;
}

template <class ConcurrencyTag, class T, class Value, class Join>
T blocked_reduce(std::size_t n,
                 T init,
                 const Value& value,
                 const Join& join,
                 std::size_t block = default_block)
{
  std::vector<T> partial;
  return blocked_reduce<ConcurrencyTag>(n, init, value, join, block, partial);
}

/// Runs two independent functions, concurrently if the tag allows it.
template <class ConcurrencyTag, class F, class G>
void invoke_both(const F& f, const G& g)
{
  if constexpr (is_parallel<ConcurrencyTag>()) {
#if PCS_HAS_TBB
    const auto both = [&](std::size_t i) {
      if (i == 0)
        f();
      else
        g();
    };
    run_two_tasks(Index_function(both));
    return;
#endif
  }
  f();
  g();
}

/// A task that one of two threads executes, whichever comes first, and the other one waits for.
template <class F>
class Shared_task
{
public:
  explicit Shared_task(const F& f) : m_f(f) {}

  /// Executes the task, unless it was taken before.
  void run()
  {
    if (m_is_taken.exchange(true))
      return;
    try {
      m_f();
    } catch (...) {
      m_error = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(m_mutex);
    m_has_ended = true;
    m_ended.notify_all();
  }

  /// Waits for the end of the task, and calls `while_waiting()` again and again.
  template <class While_waiting>
  void wait(const While_waiting& while_waiting)
  {
    constexpr std::chrono::milliseconds between_calls(10);
    std::unique_lock<std::mutex> lock(m_mutex);
    while (!m_ended.wait_for(lock, between_calls, [&] { return m_has_ended; })) {
      lock.unlock();
      while_waiting();
      lock.lock();
    }
  }

  /// The exception of the task, after its end.
  const std::exception_ptr& error() const { return m_error; }

private:
  const F& m_f;
  std::atomic<bool> m_is_taken{false};
  bool m_has_ended = false;
  std::exception_ptr m_error;
  std::mutex m_mutex;
  std::condition_variable m_ended;
};

/// Runs two independent functions, concurrently if the tag allows it, the first one in the calling
/// thread. While this thread waits for the second one, it calls `while_waiting()` every 10 ms.
/// Exceptions of all three are rethrown after both functions have ended.
template <class ConcurrencyTag, class F, class G, class While_waiting>
void invoke_both(const F& f, const G& g, [[maybe_unused]] const While_waiting& while_waiting)
{
  if constexpr (is_parallel<ConcurrencyTag>()) {
#if PCS_HAS_TBB
    Shared_task<G> other(g);
    std::exception_ptr error;
    const auto guarded = [&](const auto& task) {
      try {
        task();
      } catch (...) {
        error = std::current_exception();
      }
    };
#if defined(PCS_HAS_THREAD_SANITIZER)
    std::thread thread([&] { other.run(); });
#else
    tbb::task_group tasks;
    tasks.run([&] { other.run(); });
#endif
    guarded(f);
#if !defined(PCS_HAS_THREAD_SANITIZER)
    other.run();
#endif
    guarded([&] { other.wait(while_waiting); });
    other.wait([] {});
#if defined(PCS_HAS_THREAD_SANITIZER)
    thread.join();
#else
    tasks.wait();
#endif
    if (!error)
      error = other.error();
    if (error)
      std::rethrow_exception(error);
    return;
#endif
  }
  f();
  g();
}

/// Calls `f`; while its loops wait for other threads, this thread does not begin other tasks.
template <class ConcurrencyTag, class F>
void run_isolated(const F& f)
{
#if PCS_HAS_TBB && !defined(PCS_HAS_THREAD_SANITIZER)
  if constexpr (is_parallel<ConcurrencyTag>()) {
    tbb::this_task_arena::isolate(f);
    return;
  }
#endif
  f();
}

/*!
  Calls `f(i)` once for every `i` in `[0, n)`, for few long tasks that may be parallel themselves.
  The calling thread takes part. While it waits for the others, it calls `while_waiting()` every
  10 ms. After an exception, no further tasks are begun; it is rethrown when all have ended.
*/
template <class ConcurrencyTag, class F, class While_waiting>
void for_each_long_task(std::size_t n, const F& f, const While_waiting& while_waiting)
{
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < n; i = next++)
        internal::run_isolated<ConcurrencyTag>([&f, i] { f(i); });
    } catch (...) {
      next = n;
      throw;
    }
  };
  const auto work_beside = [&] {
    internal::for_each_index<ConcurrencyTag>(
        n - std::min<std::size_t>(n, 1),
        [&](std::size_t) { work(); },
        1);
  };
  internal::invoke_both<ConcurrencyTag>(work, work_beside, while_waiting);
}

/// Sorts by `less`, which must be a total order so that the result is independent of the schedule.
template <class ConcurrencyTag, class Iterator, class Less>
void sort(Iterator begin, Iterator end, const Less& less)
{
  const auto n = static_cast<std::size_t>(end - begin);
  if (!is_parallel<ConcurrencyTag>() || n < 4 * default_block) {
    std::sort(begin, end, less);
    return;
  }
  const auto middle = begin + (end - begin) / 2;
  invoke_both<ConcurrencyTag>([&] { pcs::internal::sort<ConcurrencyTag>(begin, middle, less); },
                              [&] { pcs::internal::sort<ConcurrencyTag>(middle, end, less); });
  std::inplace_merge(begin, middle, end, less);
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_PARALLEL_H
