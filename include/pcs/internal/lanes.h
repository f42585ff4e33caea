// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Short vectors of numbers for kernels: the compiler's own where it has them, plain arrays elsewhere.

#ifndef PCS_INTERNAL_LANES_H
#define PCS_INTERNAL_LANES_H

#include <pcs/internal/instruction_set.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace pcs {
namespace internal {

#if (defined(__GNUC__) || defined(__clang__)) && !defined(PCS_NO_VECTOR_EXTENSIONS)

// Both compilers split a vector that the machine does not have; the operations, and so the bits, stay the same.
using Float8 = float __attribute__((vector_size(32)));
using Double4 = double __attribute__((vector_size(32)));
using Float4 = float __attribute__((vector_size(16)));
using Uint16x8 = std::uint16_t __attribute__((vector_size(16)));

PCS_ALWAYS_INLINE void to_float(const Uint16x8& from, Float8& to)
{
  to = __builtin_convertvector(from, Float8);
}

/// Lanes 0 to 3 (`Half` 0) or 4 to 7 (`Half` 1).
template <std::size_t Half>
PCS_ALWAYS_INLINE void to_double(const Float8& from, Double4& to)
{
  const Float4 part = {from[4 * Half], from[4 * Half + 1], from[4 * Half + 2], from[4 * Half + 3]};
  to = __builtin_convertvector(part, Double4);
}

#else

template <class T, std::size_t N>
struct Array_lanes
{
  T v[N];
  T& operator[](std::size_t i) { return v[i]; }
  T operator[](std::size_t i) const { return v[i]; }
#define PCS_LANE_OPERATOR(op)                                                                      \
  friend Array_lanes operator op(const Array_lanes& a, const Array_lanes& b)                       \
  {                                                                                                \
    Array_lanes c;                                                                                 \
    for (std::size_t i = 0; i < N; ++i)                                                            \
      c.v[i] = a.v[i] op b.v[i];                                                                   \
    return c;                                                                                      \
  }                                                                                                \
  friend Array_lanes operator op(const Array_lanes& a, T b)                                        \
  {                                                                                                \
    Array_lanes c;                                                                                 \
    for (std::size_t i = 0; i < N; ++i)                                                            \
      c.v[i] = a.v[i] op b;                                                                        \
    return c;                                                                                      \
  }                                                                                                \
  friend Array_lanes operator op(T a, const Array_lanes& b)                                        \
  {                                                                                                \
    Array_lanes c;                                                                                 \
    for (std::size_t i = 0; i < N; ++i)                                                            \
      c.v[i] = a op b.v[i];                                                                        \
    return c;                                                                                      \
  }
  PCS_LANE_OPERATOR(+)
  PCS_LANE_OPERATOR(-)
  PCS_LANE_OPERATOR(*)
  PCS_LANE_OPERATOR(/)
#undef PCS_LANE_OPERATOR
  Array_lanes& operator+=(const Array_lanes& b)
  {
    return *this = *this + b;
  }
};
using Float8 = Array_lanes<float, 8>;
using Double4 = Array_lanes<double, 4>;
using Uint16x8 = Array_lanes<std::uint16_t, 8>;

inline void to_float(const Uint16x8& from, Float8& to)
{
  for (std::size_t i = 0; i < 8; ++i)
    to[i] = static_cast<float>(from[i]);
}

template <std::size_t Half>
void to_double(const Float8& from, Double4& to)
{
  for (std::size_t i = 0; i < 4; ++i)
    to[i] = static_cast<double>(from[4 * Half + i]);
}

#endif

/// Loads and stores without a demand on alignment.
template <class Lanes, class T>
PCS_ALWAYS_INLINE void load(const T* from, Lanes& to)
{
  std::memcpy(&to, from, sizeof(Lanes));
}

template <class Lanes, class T>
PCS_ALWAYS_INLINE void store(const Lanes& from, T* to)
{
  std::memcpy(to, &from, sizeof(Lanes));
}

PCS_ALWAYS_INLINE void square_root(Double4& x)
{
#if defined(__SSE2__) && !defined(PCS_NO_VECTOR_EXTENSIONS)
  // std::sqrt looks at every lane for errno; this is the same correctly rounded root.
  __m128d part[2];
  std::memcpy(part, &x, sizeof(part));
  part[0] = _mm_sqrt_pd(part[0]);
  part[1] = _mm_sqrt_pd(part[1]);
  std::memcpy(&x, part, sizeof(part));
#else
  for (std::size_t i = 0; i < 4; ++i)
    x[i] = std::sqrt(x[i]);
#endif
}

/// Calls `f(std::integral_constant<std::size_t, I>)` for I = 0 ... N - 1, unrolled: arrays of lanes that are
/// indexed by constants live in registers.
template <class F, std::size_t... I>
PCS_ALWAYS_INLINE void unroll(const F& f, std::index_sequence<I...>)
{
  (f(std::integral_constant<std::size_t, I>()), ...);
}
template <std::size_t N, class F>
PCS_ALWAYS_INLINE void unroll(const F& f)
{
  unroll(f, std::make_index_sequence<N>());
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_LANES_H
