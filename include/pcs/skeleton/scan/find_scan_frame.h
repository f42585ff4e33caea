// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Search for the canonical frame of a scan.

#ifndef PCS_SKELETON_SCAN_FIND_SCAN_FRAME_H
#define PCS_SKELETON_SCAN_FIND_SCAN_FRAME_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Scan_frame.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Least horizontal asymmetry of the points that determines the yaw of the frame [-].
constexpr double least_asymmetry = 1e-6;

namespace internal {

/// Computes four sums in fixed-point integers, so that the results do not depend on the order of
/// the terms. `terms(i)` returns four numbers of absolute value at most 1.
template <class ConcurrencyTag, class Terms>
std::array<double, 4> exact_sums(std::size_t n, const Terms& terms)
{
  using Sums = std::array<long long, 4>;
  const double scale = std::ldexp(1.0, 60 - std::ilogb(2.0 * double(n)));
  const auto add = [](Sums a, const Sums& b) {
    for (std::size_t k = 0; k < a.size(); ++k)
      a[k] += b[k];
    return a;
  };
  const auto rounded = [&](std::size_t i) {
    const std::array<double, 4> x = terms(i);
    return Sums{std::llround(scale * x[0]),
                std::llround(scale * x[1]),
                std::llround(scale * x[2]),
                std::llround(scale * x[3])};
  };
  const Sums sums = pcs::internal::blocked_reduce<ConcurrencyTag>(n, Sums{}, rounded, add);
  return {double(sums[0]) / scale,
          double(sums[1]) / scale,
          double(sums[2]) / scale,
          double(sums[3]) / scale};
}

} // namespace internal

/// Finds origin, unit of length and axes of a scan. They do not depend on the order of the points.
/// `input` must be finite and not empty, and `up` a unit vector. O(n).
template <class ConcurrencyTag>
Scan_frame find_scan_frame(const std::vector<Vec3>& input, const Vec3& up)
{
  using Terms = std::array<double, 4>;
  Scan_frame frame;
  const std::size_t n = input.size();
  Vec3 low = input.front(), high = low;
  for (const Vec3& p : input) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double extent = (high - low).maxCoeff();
  const bool is_extended = extent > 0 && std::isfinite(extent);
  const auto place = [&](const Vec3& p) { return Vec3((p - low) / extent); };
  // a weighted mean that is robust against outliers; weights decrease smoothly with the distance,
  // so that rounding has little effect
  constexpr int rounds = 3;
  Vec3 center = Vec3::Zero();
  double reach = 0;
  const auto weight = [&](double squared_distance) {
    const double x = reach > 0 ? squared_distance / (reach * reach) : 0;
    return 1 / ((1 + x) * (1 + x));
  };
  std::vector<double> distance(is_extended ? n : 0);
  for (int round = 0; round < rounds && is_extended; ++round) {
    const Terms sums = internal::exact_sums<ConcurrencyTag>(n, [&](std::size_t i) {
      const Vec3 d = place(input[i]);
      const double w = weight((d - center).squaredNorm());
      return Terms{w * d.x(), w * d.y(), w * d.z(), w};
    });
    if (!(sums[3] > 0))
      break;
    center = Vec3(sums[0], sums[1], sums[2]) / sums[3];
    pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
      distance[i] = (place(input[i]) - center).squaredNorm();
    });
    reach = std::sqrt(pcs::internal::upper_median(distance));
  }
  frame.origin = is_extended ? Vec3(low + extent * center) : low;
  if (is_extended)
    frame.unit = reach > 0 ? extent * reach : extent;
  Terms sums{};
  if (is_extended)
    sums = internal::exact_sums<ConcurrencyTag>(n, [&](std::size_t i) {
      // in units of the median distance: fixed-point sums then resolve the moments of slender trees
      const Vec3 d = (place(input[i]) - center) / (reach > 0 ? reach : 1),
                 across = d - up.dot(d) * up;
      const double r2 = d.squaredNorm(), w = r2 / ((1 + r2) * (1 + r2));
      return Terms{w * across.x(), w * across.y(), w * across.z(), w * across.norm()};
    });
  const Vec3 moment(sums[0], sums[1], sums[2]);
  const bool is_turned = moment.norm() > least_asymmetry * sums[3];
  const Vec3 level = Vec3::UnitX() - up.x() * up;
  const Vec3 side = is_turned ? moment : level.norm() > 0.1 ? level : Vec3(up.unitOrthogonal());
  const Vec3 e1 = (side - up.dot(side) * up).normalized();
  frame.axes.row(0) = e1.transpose();
  frame.axes.row(1) = up.cross(e1).transpose();
  frame.axes.row(2) = up.transpose();
  return frame;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_FIND_SCAN_FRAME_H
