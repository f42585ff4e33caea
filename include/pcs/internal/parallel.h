// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Loops and sums over index ranges, sequential or by TBB, bit-identical for all thread counts.

#ifndef PCS_INTERNAL_PARALLEL_H
#define PCS_INTERNAL_PARALLEL_H

#include <CGAL/tags.h>

#include <algorithm>
#include <cstddef>
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

/// Calls `f(begin, end)` for consecutive blocks of at most `block` indices that cover `[0, n)`.
template <class ConcurrencyTag, class F>
void for_each_block(std::size_t n, std::size_t block, const F& f)
{
  if constexpr (is_parallel<ConcurrencyTag>()) {
#if PCS_HAS_TBB
    if (n > block) {
      const std::size_t number_of_blocks = (n + block - 1) / block;
      const auto run = [&](std::size_t b) { f(b * block, std::min(n, (b + 1) * block)); };
#if defined(PCS_HAS_THREAD_SANITIZER)
      run_tasks_in_two_threads(number_of_blocks, run);
#else
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, number_of_blocks),
                        [&](const tbb::blocked_range<std::size_t>& r) {
                          for (std::size_t b = r.begin(); b != r.end(); ++b)
                            run(b);
                        });
#endif
      return;
    }
#endif
  }
  for (std::size_t begin = 0; begin < n; begin += block)
    f(begin, std::min(n, begin + block));
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
#if defined(PCS_HAS_THREAD_SANITIZER)
    run_in_two_threads(f, g);
#else
    tbb::parallel_invoke(f, g);
#endif
    return;
#endif
  }
  f();
  g();
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
