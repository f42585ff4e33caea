// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Stores past the caches, where the machine has them.

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

/// Where not, `stream()` stores like any other.
constexpr bool has_streaming_stores = PCS_HAS_STREAMING_STORES != 0;

/// Bytes that `to` in `stream()` must be a multiple of.
constexpr std::size_t stream_alignment = 16;

#if PCS_HAS_STREAMING_STORES

/// Two numbers that lie, or are to lie, side by side.
using Double_pair = __m128d;

PCS_ALWAYS_INLINE Double_pair load_pair(const double* from)
{
  return _mm_loadu_pd(from);
}
/// The first of `a` and the first of `b`.
PCS_ALWAYS_INLINE Double_pair first_of(Double_pair a, Double_pair b)
{
  return _mm_unpacklo_pd(a, b);
}
PCS_ALWAYS_INLINE Double_pair second_of(Double_pair a, Double_pair b)
{
  return _mm_unpackhi_pd(a, b);
}
/// The first of `a` and the second of `b`.
PCS_ALWAYS_INLINE Double_pair across(Double_pair a, Double_pair b)
{
  return _mm_shuffle_pd(a, b, 2);
}

/// Writes two numbers that are not read again soon: a store would first read the memory around
/// them. Lines of 64 bytes should be written at one go, from the first to the last byte.
PCS_ALWAYS_INLINE void stream(Double_pair both, double* to)
{
#if defined(__GNUC__) || defined(__clang__)
  // Clang joins equal ends of branches and forgets what kind of store they have; one common store
  // among the others to a line makes it ten times as slow.
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

/// Comes after the last `stream()`, before another thread may read what was written.
PCS_ALWAYS_INLINE void end_stream()
{
#if PCS_HAS_STREAMING_STORES
  _mm_sfence();
#endif
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_STREAMING_STORES_H
