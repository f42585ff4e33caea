// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Random pairs of points at given distances, without a search structure.

#ifndef PCS_SKELETON_REGISTRATION_POINT_PAIRS_H
#define PCS_SKELETON_REGISTRATION_POINT_PAIRS_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

struct Point_pair
{
  Vec3 middle, step;

  Vec3 first() const { return middle - 0.5 * step; }
  Vec3 second() const { return middle + 0.5 * step; }
};

/// Draws pairs from points in octree order: points that are close in this order are close in space.
class Pair_source
{
public:
  explicit Pair_source(const std::vector<Vec3>& points)
    : m_points(points), m_spacing(usual_spacing())
  {
  }

  /// Returns the median distance of points to the nearest of their neighbours in the order [L].
  double spacing() const { return m_spacing; }

  /// Draws up to `most` pairs with distances in [`low`, `high`], evenly over the points. The result
  /// is deterministic. O(most).
  template <class ConcurrencyTag>
  std::vector<Point_pair> draw(double low, double high, std::size_t most) const
  {
    std::vector<Point_pair> pairs;
    const std::size_t n = m_points.size(), step = 1 + n / most;
    const double x = high / m_spacing,
                 around = 4 * x * x; // number of points of a surface within `high`
    const std::size_t reach = static_cast<std::size_t>(std::min(double(n), around));
    std::vector<std::size_t> partners;
    for (std::size_t round = 0; round * n < most * step && pairs.size() < most; ++round) {
      const std::size_t first = round % step;
      partners.resize(first < n ? 1 + (n - 1 - first) / step : 0);
      pcs::internal::for_each_index<ConcurrencyTag>(partners.size(), [&](std::size_t k) {
        partners[k] = partner(first + k * step, round * n, reach, low, high);
      });
      for (std::size_t k = 0; k < partners.size() && pairs.size() < most; ++k)
        if (partners[k] < n) {
          const Vec3 &a = m_points[first + k * step], &b = m_points[partners[k]];
          pairs.push_back({0.5 * (a + b), b - a});
        }
    }
    return pairs;
  }

private:
  /// Returns a point with a distance in [`low`, `high`] from point `i`, or the number of points if
  /// all tries fail.
  std::size_t
  partner(std::size_t i, std::size_t seed, std::size_t reach, double low, double high) const
  {
    constexpr std::size_t tries = 16;
    for (std::size_t k = 0; k < tries; ++k) {
      const std::size_t j = i + 1 + scattered((seed + i) * tries + k, reach);
      if (j >= m_points.size())
        continue;
      const double distance = (m_points[j] - m_points[i]).norm();
      if (distance >= low && distance <= high)
        return j;
    }
    return m_points.size();
  }

  /// Returns a pseudo-random number in [0, n) that depends only on `i`.
  static std::size_t scattered(std::size_t i, std::size_t n)
  {
    std::uint64_t x = (std::uint64_t(i) + 1) * 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 32)) * 0xD6E8FEB86659FD93u;
    return static_cast<std::size_t>((x ^ (x >> 32)) % n);
  }

  double usual_spacing() const
  {
    constexpr std::size_t enough = 2000, around = 12;
    const std::size_t n = m_points.size(), count = std::min(enough, n);
    std::vector<double> distances;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = k * n / count, end = std::min(n, i + around + 1);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t j = i > around ? i - around : 0; j < end; ++j)
        if (j != i)
          least = std::min(least, (m_points[i] - m_points[j]).norm());
      distances.push_back(least);
    }
    return pcs::internal::lower_median(distances);
  }

  const std::vector<Vec3>& m_points;
  double m_spacing;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_POINT_PAIRS_H
