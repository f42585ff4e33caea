// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Vectors of four floats for the rays of a beam: SSE2 if available, otherwise plain loops with
// bitwise identical results.

#ifndef PCS_GENERATORS_INTERNAL_RAY_LANES_H
#define PCS_GENERATORS_INTERNAL_RAY_LANES_H

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace pcs {
namespace generators {
namespace internal {

constexpr int number_of_lanes = 4;

#if defined(__SSE2__)

struct Ray_lanes
{
  __m128 v;

  static Ray_lanes of(float x) { return {_mm_set1_ps(x)}; }
  static Ray_lanes from(const float* x) { return {_mm_loadu_ps(x)}; }
  void to(float* x) const { _mm_storeu_ps(x, v); }
  Ray_lanes operator+(Ray_lanes b) const { return {_mm_add_ps(v, b.v)}; }
  Ray_lanes operator-(Ray_lanes b) const { return {_mm_sub_ps(v, b.v)}; }
  Ray_lanes operator*(Ray_lanes b) const { return {_mm_mul_ps(v, b.v)}; }
  Ray_lanes operator/(Ray_lanes b) const { return {_mm_div_ps(v, b.v)}; }
  friend Ray_lanes min(Ray_lanes a, Ray_lanes b) { return {_mm_min_ps(a.v, b.v)}; }
  friend Ray_lanes max(Ray_lanes a, Ray_lanes b) { return {_mm_max_ps(a.v, b.v)}; }
  /// Returns one bit for each lane in which `a <= b`.
  friend int mask_of_at_most(Ray_lanes a, Ray_lanes b)
  {
    return _mm_movemask_ps(_mm_cmple_ps(a.v, b.v));
  }
};

#else

struct Ray_lanes
{
  float v[number_of_lanes];

  static Ray_lanes of(float x) { return {{x, x, x, x}}; }
  static Ray_lanes from(const float* x) { return {{x[0], x[1], x[2], x[3]}}; }
  void to(float* x) const
  {
    for (int i = 0; i < number_of_lanes; ++i)
      x[i] = v[i];
  }
  template <class F>
  static Ray_lanes each(const Ray_lanes& a, const Ray_lanes& b, const F& f)
  {
    Ray_lanes c;
    for (int i = 0; i < number_of_lanes; ++i)
      c.v[i] = f(a.v[i], b.v[i]);
    return c;
  }
  Ray_lanes operator+(const Ray_lanes& b) const
  {
    return each(*this, b, [](float x, float y) { return x + y; });
  }
  Ray_lanes operator-(const Ray_lanes& b) const
  {
    return each(*this, b, [](float x, float y) { return x - y; });
  }
  Ray_lanes operator*(const Ray_lanes& b) const
  {
    return each(*this, b, [](float x, float y) { return x * y; });
  }
  Ray_lanes operator/(const Ray_lanes& b) const
  {
    return each(*this, b, [](float x, float y) { return x / y; });
  }
  friend Ray_lanes min(const Ray_lanes& a, const Ray_lanes& b)
  {
    return each(a, b, [](float x, float y) { return x < y ? x : y; });
  }
  friend Ray_lanes max(const Ray_lanes& a, const Ray_lanes& b)
  {
    return each(a, b, [](float x, float y) { return x > y ? x : y; });
  }
  friend int mask_of_at_most(const Ray_lanes& a, const Ray_lanes& b)
  {
    int mask = 0;
    for (int i = 0; i < number_of_lanes; ++i)
      mask |= (a.v[i] <= b.v[i] ? 1 : 0) << i;
    return mask;
  }
};

#endif

} // namespace internal
} // namespace generators
} // namespace pcs

#endif // PCS_GENERATORS_INTERNAL_RAY_LANES_H
