// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stores that bypass the caches, on machines that have such instructions.

#ifndef PCS_INTERNAL_STREAMING_STORES_H
#define PCS_INTERNAL_STREAMING_STORES_H

#include <pcs/internal/instruction_set.h>

#include <cstddef>

#if defined(__SSE2__) && !defined(PCS_NO_STREAMING_STORES)
#include <emmintrin.h>
#define PCS_HAS_STREAMING_STORES 1
#else
#define PCS_HAS_STREAMING_STORES 0
#endif

namespace pcs {
namespace internal {

/// Whether `stream()` bypasses the cache; otherwise it is an ordinary store.
constexpr bool has_streaming_stores = PCS_HAS_STREAMING_STORES != 0;

/// Required alignment of `to` in `stream()`. [byte]
constexpr std::size_t stream_alignment = 16;

#if PCS_HAS_STREAMING_STORES

/// Two numbers that are adjacent in memory.
using Double_pair = __m128d;

PCS_ALWAYS_INLINE Double_pair load_pair(const double* from)
{
  return _mm_loadu_pd(from);
}
/// Returns the first elements of `a` and `b`.
PCS_ALWAYS_INLINE Double_pair first_of(Double_pair a, Double_pair b)
{
  return _mm_unpacklo_pd(a, b);
}
PCS_ALWAYS_INLINE Double_pair second_of(Double_pair a, Double_pair b)
{
  return _mm_unpackhi_pd(a, b);
}
/// Returns the first element of `a` and the second element of `b`.
PCS_ALWAYS_INLINE Double_pair across(Double_pair a, Double_pair b)
{
  return _mm_shuffle_pd(a, b, 2);
}

/// Writes two numbers that are not read again soon, without first reading their cache line. Cache
/// lines of 64 bytes should be written completely, from the first to the last byte.
PCS_ALWAYS_INLINE void stream(Double_pair both, double* to)
{
#if defined(__GNUC__) || defined(__clang__)
  // Clang merges equal ends of branches and replaces the streaming store by an ordinary one. A
  // single ordinary store among the streaming stores to a cache line makes them ten times as slow.
#ifdef __AVX__
  __asm__ volatile("vmovntpd %1, %0" : "=m"(*reinterpret_cast<__m128d*>(to)) : "x"(both));
#else
  __asm__ volatile("movntpd %1, %0" : "=m"(*reinterpret_cast<__m128d*>(to)) : "x"(both));
#endif
#else
  _mm_stream_pd(to, both);
#endif
}

#else

struct Double_pair
{
  double first, second;
};

inline Double_pair load_pair(const double* from)
{
  return {from[0], from[1]};
}
inline Double_pair first_of(Double_pair a, Double_pair b)
{
  return {a.first, b.first};
}
inline Double_pair second_of(Double_pair a, Double_pair b)
{
  return {a.second, b.second};
}
inline Double_pair across(Double_pair a, Double_pair b)
{
  return {a.first, b.second};
}
inline void stream(Double_pair both, double* to)
{
  to[0] = both.first;
  to[1] = both.second;
}

#endif

/// Must follow the last `stream()` before another thread reads the data.
PCS_ALWAYS_INLINE void end_stream()
{
#if PCS_HAS_STREAMING_STORES
  _mm_sfence();
#endif
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_STREAMING_STORES_H
