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

namespace pcs {
namespace internal {

#if (defined(__GNUC__) || defined(__clang__)) && !defined(PCS_NO_VECTOR_EXTENSIONS)

// Both compilers split a vector that the machine does not have; the operations, and so the bits, stay the same.
using Float8 = float __attribute__((vector_size(32)));
using Double4 = double __attribute__((vector_size(32)));
using Double8 = double __attribute__((vector_size(64)));
using Float16 = float __attribute__((vector_size(64)));
using Float4 = float __attribute__((vector_size(16)));
using Uint16x8 = std::uint16_t __attribute__((vector_size(16)));

PCS_ALWAYS_INLINE void to_float(const Uint16x8& from, Float8& to)
{
  to = __builtin_convertvector(from, Float8);
}

constexpr std::uint64_t reciprocal_root_bits = 0x5fe6eb50c7b537a9;

PCS_ALWAYS_INLINE void guess_reciprocal_root(const Double4& x, Double4& y)
{
  using Bits = std::uint64_t __attribute__((vector_size(32)));
  y = reinterpret_cast<Double4>(reciprocal_root_bits - (reinterpret_cast<Bits>(x) >> 1));
}
PCS_ALWAYS_INLINE void guess_reciprocal_root(const Double8& x, Double8& y)
{
  using Bits = std::uint64_t __attribute__((vector_size(64)));
  y = reinterpret_cast<Double8>(reciprocal_root_bits - (reinterpret_cast<Bits>(x) >> 1));
}

/// Lanes 0 to 3 (`Part` 0) or 4 to 7 (`Part` 1).
template <std::size_t Part>
PCS_ALWAYS_INLINE void to_double(const Float8& from, Double4& to)
{
  const Float4 part = {from[4 * Part], from[4 * Part + 1], from[4 * Part + 2], from[4 * Part + 3]};
  to = __builtin_convertvector(part, Double4);
}

/// All lanes alike. A list of eight equal values would be put together one by one.
template <class T, class Lanes>
PCS_ALWAYS_INLINE void fill(T value, Lanes& to)
{
  to = value - Lanes{};
}

#ifdef PCS_HAS_AVX_ASSEMBLY
/// GCC puts eight doubles together one by one even so.
PCS_ALWAYS_INLINE void fill(double value, Double8& to)
{
  __asm__("vbroadcastsd %1, %0" : "=v"(to) : "vm"(value));
}
#endif

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
using Double8 = Array_lanes<double, 8>;
using Uint16x8 = Array_lanes<std::uint16_t, 8>;

inline void to_float(const Uint16x8& from, Float8& to)
{
  for (std::size_t i = 0; i < 8; ++i)
    to[i] = static_cast<float>(from[i]);
}

constexpr std::uint64_t reciprocal_root_bits = 0x5fe6eb50c7b537a9;

template <std::size_t N>
void guess_reciprocal_root(const Array_lanes<double, N>& x, Array_lanes<double, N>& y)
{
  for (std::size_t i = 0; i < N; ++i) {
    std::uint64_t bits;
    std::memcpy(&bits, &x.v[i], sizeof(bits));
    bits = reciprocal_root_bits - (bits >> 1);
    std::memcpy(&y.v[i], &bits, sizeof(bits));
  }
}

template <class T, std::size_t N>
void fill(T value, Array_lanes<T, N>& to)
{
  for (std::size_t i = 0; i < N; ++i)
    to[i] = value;
}

template <std::size_t Part, std::size_t N>
void to_double(const Float8& from, Array_lanes<double, N>& to)
{
  for (std::size_t i = 0; i < N; ++i)
    to[i] = static_cast<double>(from[N * Part + i]);
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

/// Asks for `bytes` of memory that are read soon.
PCS_ALWAYS_INLINE void prefetch([[maybe_unused]] const void* memory,
                                [[maybe_unused]] std::size_t bytes)
{
#if defined(__GNUC__) || defined(__clang__)
  constexpr std::size_t cache_line = 64;
  const char* begin = static_cast<const char*>(memory);
  for (std::size_t b = 0; b < bytes; b += cache_line)
    __builtin_prefetch(begin + b);
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

/*!
  How a kernel computes, on the doubles that fit a register: `fma` is `x * y + z` with one rounding, and nothing else is
  fused, so that all kernels give the same bits; `subtract_product` is `z - x * y`. `to_float` reads eight weights,
  `to_double` widens a part of them.
*/
struct Portable_arithmetic
{
  using Doubles = Double4;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z)
  {
    z = std::fma(-x, y, z);
  }

  template <class Lanes>
  static PCS_ALWAYS_INLINE void fma(const Lanes& x, const Lanes& y, Lanes& z)
  {
    for (std::size_t i = 0; i < sizeof(Lanes) / sizeof(x[0]); ++i)
      z[i] = std::fma(x[i], y[i], z[i]);
  }
  template <class Lanes>
  static PCS_ALWAYS_INLINE void subtract_product(const Lanes& x, const Lanes& y, Lanes& z)
  {
    for (std::size_t i = 0; i < sizeof(Lanes) / sizeof(x[0]); ++i)
      z[i] = std::fma(-x[i], y[i], z[i]);
  }
  static PCS_ALWAYS_INLINE void to_float(const std::uint16_t* from, Float8& to)
  {
    Uint16x8 steps;
    load(from, steps);
    internal::to_float(steps, to);
  }
  template <std::size_t Part>
  static PCS_ALWAYS_INLINE void to_double(const Float8& from, Doubles& to)
  {
    internal::to_double<Part>(from, to);
  }
};

#ifdef PCS_HAS_AVX_ASSEMBLY
// Written out: whether a compiler fuses `x * y + z` depends on its options, and conversions it takes to pieces.
PCS_ALWAYS_INLINE void read_weights(const std::uint16_t* from, Float8& to)
{
  Uint16x8 steps;
  load(from, steps);
  __asm__("vpmovzxwd %1, %0\n\tvcvtdq2ps %0, %0" : "=x"(to) : "x"(steps));
}

struct Avx2_arithmetic
{
  using Doubles = Double4;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z)
  {
    z = std::fma(-x, y, z);
  }
  static PCS_ALWAYS_INLINE void fma(const Float8& x, const Float8& y, Float8& z)
  {
    __asm__("vfmadd231ps %2, %1, %0" : "+x"(z) : "x"(x), "x"(y));
  }
  static PCS_ALWAYS_INLINE void fma(const Double4& x, const Double4& y, Double4& z)
  {
    __asm__("vfmadd231pd %2, %1, %0" : "+x"(z) : "x"(x), "x"(y));
  }
  static PCS_ALWAYS_INLINE void subtract_product(const Double4& x, const Double4& y, Double4& z)
  {
    __asm__("vfnmadd231pd %2, %1, %0" : "+x"(z) : "x"(x), "x"(y));
  }
  static PCS_ALWAYS_INLINE void to_float(const std::uint16_t* from, Float8& to)
  {
    read_weights(from, to);
  }
  template <std::size_t Part>
  static PCS_ALWAYS_INLINE void to_double(const Float8& from, Double4& to)
  {
    const Float4 part = {from[4 * Part],
                         from[4 * Part + 1],
                         from[4 * Part + 2],
                         from[4 * Part + 3]};
    __asm__("vcvtps2pd %1, %0" : "=x"(to) : "x"(part));
  }
};

struct Avx512_arithmetic
{
  using Doubles = Double8;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z)
  {
    z = std::fma(-x, y, z);
  }
  static PCS_ALWAYS_INLINE void fma(const Float16& x, const Float16& y, Float16& z)
  {
    __asm__("vfmadd231ps %2, %1, %0" : "+v"(z) : "v"(x), "v"(y));
  }
  static PCS_ALWAYS_INLINE void fma(const Double8& x, const Double8& y, Double8& z)
  {
    __asm__("vfmadd231pd %2, %1, %0" : "+v"(z) : "v"(x), "v"(y));
  }
  static PCS_ALWAYS_INLINE void subtract_product(const Double8& x, const Double8& y, Double8& z)
  {
    __asm__("vfnmadd231pd %2, %1, %0" : "+v"(z) : "v"(x), "v"(y));
  }
  template <std::size_t Part>
  static PCS_ALWAYS_INLINE void to_double(const Float8& from, Double8& to)
  {
    __asm__("vcvtps2pd %1, %0" : "=v"(to) : "v"(from));
  }
};
#elif PCS_HAS_RUNTIME_DISPATCH
using Avx2_arithmetic = Portable_arithmetic;
#endif

/// Sums `w[l] * d[k]` over pairs of weights `w` of eight lanes and numbers `d[k]`, for `k` below `N`.
template <class Arithmetic, std::size_t N>
struct Lane_sums
{
  Float8 sum[N] = {};

  PCS_ALWAYS_INLINE void add(const std::uint16_t* weight, const float* d)
  {
    Float8 w;
    Arithmetic::to_float(weight, w);
    unroll<N>([&](auto k) PCS_LAMBDA_INLINE {
      Float8 all;
      fill(d[k], all);
      Arithmetic::fma(w, all, sum[k]);
    });
  }
  PCS_ALWAYS_INLINE void finish() {}
};

#ifdef PCS_HAS_AVX_ASSEMBLY
/// Two numbers share a register, in turns: narrower ones would leave half of each unit idle.
template <std::size_t N>
struct Lane_sums<Avx512_arithmetic, N>
{
  static_assert(N % 2 == 0);
  Float8 sum[N];
  Float16 pair[N / 2] = {};

  PCS_ALWAYS_INLINE void add(const std::uint16_t* weight, const float* d)
  {
    Float8 once;
    read_weights(weight, once);
    const Float16 w =
        __builtin_shufflevector(once, once, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
    unroll<N / 2>([&](auto k) PCS_LAMBDA_INLINE {
      double two; // moved only
      std::memcpy(&two, d + 2 * k, sizeof(two));
      const Double8 all = {two, two, two, two, two, two, two, two};
      Avx512_arithmetic::fma(w, reinterpret_cast<Float16>(all), pair[k]);
    });
  }
  PCS_ALWAYS_INLINE void finish()
  {
    unroll<N / 2>([&](auto k) PCS_LAMBDA_INLINE {
      const Float16& p = pair[k];
      sum[2 * k] = __builtin_shufflevector(p, p, 0, 2, 4, 6, 8, 10, 12, 14);
      sum[2 * k + 1] = __builtin_shufflevector(p, p, 1, 3, 5, 7, 9, 11, 13, 15);
    });
  }
};
#endif

/*!
  `1 / sqrt(x)` to one or two units in the last place, from a guess on the bits of `x`: neither a division nor a root,
  which take longer than all else in a kernel. `x` must be positive. With `d = 1 - x y^2`, the series
  `1 / sqrt(x) = y (1 + d / 2 + 3 d^2 / 8 + 5 d^3 / 16 + ...)` is cut after `d^3`, then once more after `d^2`: from an
  error of 3.5 % to 7e-6 and to 1e-15, in a shorter chain than four steps of Newton.
*/
template <class Arithmetic>
PCS_ALWAYS_INLINE void reciprocal_root(const typename Arithmetic::Doubles& x,
                                       typename Arithmetic::Doubles& y)
{
  using Doubles = typename Arithmetic::Doubles;
  // M. Robertson, "A Brief History of InvSqrt" (2012): the constant for doubles.
  guess_reciprocal_root(x, y);
  Doubles half, cubic;
  fill(0.5, half);
  fill(0.375, cubic);
  unroll<2>([&](auto step) PCS_LAMBDA_INLINE {
    Doubles d, factor = cubic;
    fill(1.0, d);
    Arithmetic::subtract_product(x, Doubles(y * y), d);
    if constexpr (decltype(step)::value == 0) {
      Doubles quartic;
      fill(0.3125, quartic);
      Arithmetic::fma(quartic, d, factor);
    }
    const Doubles correction = y * d;
    Doubles sum = half;
    Arithmetic::fma(factor, d, sum);
    Arithmetic::fma(sum, correction, y);
  });
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_LANES_H
