// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Pairs of points at given distances, without a search structure.

#ifndef PCS_SKELETON_POINT_PAIRS_H
#define PCS_SKELETON_POINT_PAIRS_H

#include <pcs/skeleton/Scan.h>

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

/// Draws pairs from points that are sorted along an octree: those that are near in this order are near in space.
class Pair_source
{
public:
  explicit Pair_source(const std::vector<Vec3>& points)
    : m_points(points), m_spacing(usual_spacing())
  {
  }

  /// Median distance of points to the nearest of those around them in the order [L].
  double spacing() const { return m_spacing; }

  /// Up to `most` pairs whose distances are in [`low`, `high`], evenly; the same ones on each call. O(most).
  std::vector<Point_pair> draw(double low, double high, std::size_t most) const
  {
    constexpr std::size_t tries = 16; // for each
    std::vector<Point_pair> pairs;
    const std::size_t n = m_points.size(), step = 1 + n / most;
    const double x = high / m_spacing,
                 around = 4 * x * x; // surfaces have so many points within `high`
    const std::size_t reach = static_cast<std::size_t>(std::min(double(n), around));
    for (std::size_t round = 0; round * n < most * step && pairs.size() < most; ++round)
      for (std::size_t i = round % step; i < n && pairs.size() < most; i += step)
        for (std::size_t k = 0; k < tries; ++k) {
          const std::size_t j = i + 1 + scattered((round * n + i) * tries + k, reach);
          if (j >= n)
            continue;
          const double distance = (m_points[j] - m_points[i]).norm();
          if (distance < low || distance > high)
            continue;
          pairs.push_back({0.5 * (m_points[i] + m_points[j]), m_points[j] - m_points[i]});
          break;
        }
    return pairs;
  }

private:
  /// A number in [0, n) that depends on `i` alone.
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
    return median(distances);
  }

  const std::vector<Vec3>& m_points;
  double m_spacing;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_POINT_PAIRS_H
