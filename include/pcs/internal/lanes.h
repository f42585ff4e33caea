// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Short SIMD vectors for kernels: compiler extensions where available, plain arrays elsewhere.

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

// Compilers split vectors that are wider than the registers of the machine. The operations, and
// thus the bits, are unchanged.
using Double2 = double __attribute__((vector_size(16))); // on every machine
using Double4 = double __attribute__((vector_size(32)));
using Double8 = double __attribute__((vector_size(64)));
using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
/// Eight integers without alignment.
using Uint16x8 = std::uint16_t __attribute__((vector_size(16), aligned(2), may_alias));

constexpr std::uint64_t reciprocal_root_bits = 0x5fe6eb50c7b537a9;

PCS_ALWAYS_INLINE void guess_reciprocal_root(const Double2& x, Double2& y)
{
  using Bits = std::uint64_t __attribute__((vector_size(16)));
  y = reinterpret_cast<Double2>(reciprocal_root_bits - (reinterpret_cast<Bits>(x) >> 1));
}
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

/// Sets all lanes to one value. An initialiser list would insert the values one by one.
template <class T, class Lanes>
PCS_ALWAYS_INLINE void fill(T value, Lanes& to)
{
  to = value - Lanes{};
}

/// Selects lane by lane `a < b ? x : y`; `to` may be one of the arguments.
template <class Lanes>
PCS_ALWAYS_INLINE void
select_less(const Lanes& a, const Lanes& b, const Lanes& x, const Lanes& y, Lanes& to)
{
  to = a < b ? x : y;
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
  Array_lanes operator-() const
  {
    Array_lanes c;
    for (std::size_t i = 0; i < N; ++i)
      c.v[i] = -v[i];
    return c;
  }
#undef PCS_LANE_OPERATOR
  Array_lanes& operator+=(const Array_lanes& b)
  {
    return *this = *this + b;
  }
};
using Double2 = Array_lanes<double, 2>;
using Double4 = Array_lanes<double, 4>;
using Double8 = Array_lanes<double, 8>;
using Float4 = Array_lanes<float, 4>;
using Float8 = Array_lanes<float, 8>;

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

template <class T, std::size_t N>
void select_less(const Array_lanes<T, N>& a,
                 const Array_lanes<T, N>& b,
                 const Array_lanes<T, N>& x,
                 const Array_lanes<T, N>& y,
                 Array_lanes<T, N>& to)
{
  for (std::size_t i = 0; i < N; ++i)
    to[i] = a[i] < b[i] ? x[i] : y[i];
}

#endif

/// Returns y, z, x, w of the lanes x, y, z, w.
PCS_ALWAYS_INLINE Float4 rotated(const Float4& v)
{
#if defined(__clang__) && !defined(PCS_NO_VECTOR_EXTENSIONS)
  return __builtin_shufflevector(v, v, 1, 2, 0, 3);
#elif defined(__GNUC__) && !defined(PCS_NO_VECTOR_EXTENSIONS)
  using Index = std::int32_t __attribute__((vector_size(16)));
  return __builtin_shuffle(v, Index{1, 2, 0, 3});
#else
  return {{v[1], v[2], v[0], v[3]}};
#endif
}

/// Unaligned loads and stores.
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

/// Prefetches `bytes` bytes of memory that are read soon; none if `memory` is null.
PCS_ALWAYS_INLINE void prefetch([[maybe_unused]] const void* memory,
                                [[maybe_unused]] std::size_t bytes)
{
#if defined(__GNUC__) || defined(__clang__)
  constexpr std::size_t cache_line = 64;
  const char* begin = static_cast<const char*>(memory);
  for (std::size_t b = 0; begin != nullptr && b < bytes; b += cache_line)
    __builtin_prefetch(begin + b);
#endif
}

/// Calls `f(std::integral_constant<std::size_t, I>)` for I = 0 ... N - 1, unrolled: with constant
/// indices, arrays of lanes remain in registers.
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
  The arithmetic of a kernel on as many doubles as a register holds. `fma` is `x * y + z` with one
  rounding; no other operation is fused, so that all kernels give the same bits. `subtract_product`
  is `z - x * y`. A scalar argument applies to all lanes. `to_doubles` converts as many quantised
  weights as there are lanes.
*/
template <class Lanes>
struct Plain_arithmetic
{
  using Doubles = Lanes;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z)
  {
    z = std::fma(-x, y, z);
  }
  static PCS_ALWAYS_INLINE void fill(const double& x, Doubles& z) { internal::fill(x, z); }
  static PCS_ALWAYS_INLINE void fma(const double& x, const Doubles& y, Doubles& z)
  {
    for (std::size_t i = 0; i < sizeof(Doubles) / sizeof(double); ++i)
      z[i] = std::fma(x, y[i], z[i]);
  }
  static PCS_ALWAYS_INLINE void fma(const Doubles& x, const Doubles& y, Doubles& z)
  {
    for (std::size_t i = 0; i < sizeof(Doubles) / sizeof(double); ++i)
      z[i] = std::fma(x[i], y[i], z[i]);
  }
  static PCS_ALWAYS_INLINE void subtract_product(const Doubles& x, const Doubles& y, Doubles& z)
  {
    for (std::size_t i = 0; i < sizeof(Doubles) / sizeof(double); ++i)
      z[i] = std::fma(-x[i], y[i], z[i]);
  }
  static PCS_ALWAYS_INLINE void subtract(const double& x, Doubles& z) { z = z - x; }
  static PCS_ALWAYS_INLINE void to_doubles(const std::uint16_t* from, Doubles& to)
  {
    for (std::size_t i = 0; i < sizeof(Doubles) / sizeof(double); ++i)
      to[i] = from[i];
  }
};

#if defined(__wasm__)
/// WebAssembly has no `x * y + z` with one rounding, and its function takes more than ten times as
/// long as two roundings. Results therefore differ from those of other machines by rounding.
template <class Lanes>
struct Twice_rounded_arithmetic : Plain_arithmetic<Lanes>
{
  using Doubles = Lanes;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z) { z -= x * y; }
  static PCS_ALWAYS_INLINE void fma(const double& x, const Doubles& y, Doubles& z)
  {
    z = z + x * y;
  }
  static PCS_ALWAYS_INLINE void fma(const Doubles& x, const Doubles& y, Doubles& z)
  {
    z = z + x * y;
  }
  static PCS_ALWAYS_INLINE void subtract_product(const Doubles& x, const Doubles& y, Doubles& z)
  {
    z = z - x * y;
  }
};

using Portable_arithmetic = Twice_rounded_arithmetic<Double4>;
/// For kernels that need most registers.
using Narrow_arithmetic = Twice_rounded_arithmetic<Double2>;
#else
using Portable_arithmetic = Plain_arithmetic<Double4>;
using Narrow_arithmetic = Portable_arithmetic;
#endif

#ifdef PCS_HAS_AVX_ASSEMBLY
// Assembly, because the fusion of `x * y + z` depends on compiler options, and because compilers
// split the conversions and broadcast scalars from registers with an additional operation instead
// of from memory.
struct Avx2_arithmetic
{
  using Doubles = Double4;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z)
  {
    z = std::fma(-x, y, z);
  }
  static PCS_ALWAYS_INLINE void fill(const double& x, Double4& z)
  {
    __asm__("vbroadcastsd %1, %0" : "=x"(z) : "m"(x));
  }
  static PCS_ALWAYS_INLINE void fma(const double& x, const Double4& y, Double4& z)
  {
    Double4 all;
    fill(x, all);
    fma(all, y, z);
  }
  static PCS_ALWAYS_INLINE void fma(const Double4& x, const Double4& y, Double4& z)
  {
    __asm__("vfmadd231pd %2, %1, %0" : "+x"(z) : "x"(x), "x"(y));
  }
  static PCS_ALWAYS_INLINE void subtract_product(const Double4& x, const Double4& y, Double4& z)
  {
    __asm__("vfnmadd231pd %2, %1, %0" : "+x"(z) : "x"(x), "x"(y));
  }
  static PCS_ALWAYS_INLINE void subtract(const double& x, Double4& z) { z = z - x; }
  static PCS_ALWAYS_INLINE void to_doubles(const std::uint16_t* from, Double4& to)
  {
    std::uint64_t four;
    std::memcpy(&four, from, sizeof(four));
    __asm__("vpmovzxwd %1, %x0\n\tvcvtdq2pd %x0, %0" : "=x"(to) : "m"(four));
  }
};

struct Avx512_arithmetic
{
  using Doubles = Double8;

  static PCS_ALWAYS_INLINE void subtract_product(double x, double y, double& z)
  {
    z = std::fma(-x, y, z);
  }
  static PCS_ALWAYS_INLINE void fill(const double& x, Double8& z)
  {
    __asm__("vbroadcastsd %1, %0" : "=v"(z) : "m"(x));
  }
  static PCS_ALWAYS_INLINE void fma(const double& x, const Double8& y, Double8& z)
  {
    __asm__("vfmadd231pd %2%{1to8%}, %1, %0" : "+v"(z) : "v"(y), "m"(x));
  }
  static PCS_ALWAYS_INLINE void fma(const Double8& x, const Double8& y, Double8& z)
  {
    __asm__("vfmadd231pd %2, %1, %0" : "+v"(z) : "v"(x), "v"(y));
  }
  static PCS_ALWAYS_INLINE void subtract_product(const Double8& x, const Double8& y, Double8& z)
  {
    __asm__("vfnmadd231pd %2, %1, %0" : "+v"(z) : "v"(x), "v"(y));
  }
  static PCS_ALWAYS_INLINE void subtract(const double& x, Double8& z)
  {
    __asm__("vsubpd %1%{1to8%}, %0, %0" : "+v"(z) : "m"(x));
  }
  static PCS_ALWAYS_INLINE void to_doubles(const std::uint16_t* from, Double8& to)
  {
    __asm__("vpmovzxwq %1, %0\n\tvcvtuqq2pd %0, %0"
            : "=v"(to)
            : "m"(*reinterpret_cast<const Uint16x8*>(from)));
  }
};
#elif PCS_HAS_RUNTIME_DISPATCH
using Avx2_arithmetic = Portable_arithmetic;
using Avx512_arithmetic = Plain_arithmetic<Double8>;
#endif

inline constexpr double reciprocal_root_series[] = {1, 0.5, 0.375, 0.3125};

/*!
  Computes `1 / sqrt(x)` to one or two units in the last place (ulp), from a guess based on the bits
  of `x`. Divisions and roots would dominate the time of a kernel. `x` must be positive.
  With `d = 1 - x y^2`, `1 / sqrt(x) = y (1 + d / 2 + 3 d^2 / 8 + 5 d^3 / 16 + ...)`. The first step
  truncates this series after `d^3`, the second after `d^2`. The error decreases from 3.5 % to 7e-6
  and to 1e-15. The chain of operations is shorter than that of four steps of Newton's method.
*/
template <class Arithmetic>
PCS_ALWAYS_INLINE void reciprocal_root(const typename Arithmetic::Doubles& x,
                                       typename Arithmetic::Doubles& y)
{
  using Doubles = typename Arithmetic::Doubles;
  // M. Robertson, "A Brief History of InvSqrt" (2012): the constant for doubles.
  guess_reciprocal_root(x, y);
  unroll<2>([&](auto step) PCS_LAMBDA_INLINE {
    constexpr const double* c = reciprocal_root_series;
    Doubles d, factor, sum;
    Arithmetic::fill(c[0], d);
    Arithmetic::subtract_product(x, Doubles(y * y), d);
    Arithmetic::fill(c[2], factor);
    if constexpr (decltype(step)::value == 0)
      Arithmetic::fma(c[3], d, factor);
    const Doubles correction = y * d;
    Arithmetic::fill(c[1], sum);
    Arithmetic::fma(factor, d, sum);
    Arithmetic::fma(sum, correction, y);
  });
}

} // namespace internal
} // namespace pcs

#endif // PCS_INTERNAL_LANES_H
