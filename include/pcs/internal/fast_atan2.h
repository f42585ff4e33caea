// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Angles of many vectors, faster than by the C library.

#ifndef PCS_INTERNAL_FAST_ATAN2_H
#define PCS_INTERNAL_FAST_ATAN2_H

#include <pcs/internal/constants.h>

#include <algorithm>
#include <cmath>

namespace pcs {
namespace skeleton {

/// Computes `std::atan2()` to 1e-11; 0 for the null vector. The function is free of branches, so
/// that loops over it are vectorised [rad].
inline double fast_atan2(double y, double x)
{
  constexpr double quarter = pcs::internal::pi / 4, least = 1e-300;
  const double a = std::abs(x), b = std::abs(y);
  const double low = std::min(a, b), high = std::max(std::max(a, b), least);
  // the tangent of the angle, reduced by pi / 4 if the angle exceeds pi / 8
  const bool is_far = low > 0.41421356237309504880 * high;
  const double t = (is_far ? low - high : low) / (is_far ? low + high : high), s = t * t;
  // Chebyshev approximation of atan(t) / t in t^2 up to tan(pi / 8)^2
  const double series = 0.9999999999783992 +
                        s * (-0.33333332097617185 +
                             s * (0.19999883856993678 +
                                  s * (-0.14281588782536198 +
                                       s * (0.11040489332791317 + s * (-0.08456193426787426 +
                                                                       s * 0.04707349203068869)))));
  const double octant = t * series + (is_far ? quarter : 0);
  const double quadrant = b > a ? 2 * quarter - octant : octant;
  const double half = x < 0 ? 4 * quarter - quadrant : quadrant;
  return y < 0 ? -half : half;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_INTERNAL_FAST_ATAN2_H
