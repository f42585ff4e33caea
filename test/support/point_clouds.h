// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Small clouds with a seed, and brute-force reference results for them.

#ifndef PCS_TEST_SUPPORT_POINT_CLOUDS_H
#define PCS_TEST_SUPPORT_POINT_CLOUDS_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace pcs_test {

using Vec3 = Eigen::Vector3d;
using Points = std::vector<Vec3>;

/// Uniform in [-1, 1]; equal on every platform, unlike std::uniform_real_distribution.
inline double uniform(std::mt19937& random)
{
  return 2 * (static_cast<double>(random()) / 4294967296) - 1;
}

inline Vec3 random_vector(std::mt19937& random)
{
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

inline Vec3 random_direction(std::mt19937& random)
{
  for (;;) {
    const Vec3 v = random_vector(random);
    if (v.squaredNorm() > 1e-2 && v.squaredNorm() < 1)
      return v.normalized();
  }
}

inline Points random_points(std::size_t n, unsigned seed)
{
  std::mt19937 random(seed);
  Points points(n);
  for (Vec3& p : points)
    p = random_vector(random);
  return points;
}

/// Ten groups of `size` points each in the corners of squares with sides of length `distance`. The
/// points of a group lie in a cube with sides of length 2.
inline Points small_groups(int size, double distance, unsigned seed)
{
  std::mt19937 random(seed);
  Points points;
  for (int group = 0; group < 10; ++group)
    for (int i = 0; i < size; ++i)
      points.push_back(distance * Vec3(group % 3, group / 3, 0) + random_vector(random));
  return points;
}

/// `(nx + 1) (ny + 1)` points in the plane z = 0, x the slow index.
inline Points plate(int nx, int ny, double spacing)
{
  Points points;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      points.emplace_back(spacing * i, spacing * j, 0);
  return points;
}

/// Points on the surface of the box [0, x] x [0, y] x [0, z], at multiples of the spacing.
inline Points box(int nx, int ny, int nz, double spacing)
{
  Points points;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k)
        if (i == 0 || j == 0 || k == 0 || i == nx || j == ny || k == nz)
          points.emplace_back(spacing * i, spacing * j, spacing * k);
  return points;
}

/// Fibonacci spiral on the unit sphere.
inline Points sphere(std::size_t n)
{
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2.0 * double(i) + 1) / double(n), a = 2.399963229728653 * double(i);
    const double r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  return points;
}

/// Two sheets of unit spacing, `gap` apart, joined at x = 0 by a half cylinder if `is_folded`.
inline Points sheets(int nx, int ny, double gap, bool is_folded)
{
  Points points;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      points.emplace_back(i, j, 0);
      points.emplace_back(i, j, gap);
    }
  if (is_folded) {
    const double pi = 3.14159265358979323846;
    const int steps = std::max(2, static_cast<int>(std::lround(pi * gap / 2)));
    for (int s = 1; s < steps; ++s)
      for (int j = 0; j <= ny; ++j) {
        const double a = pi * s / steps;
        points.emplace_back(-gap / 2 * std::sin(a), j, gap / 2 - gap / 2 * std::cos(a));
      }
  }
  return points;
}

inline std::vector<std::uint32_t> random_permutation(std::size_t n, unsigned seed)
{
  std::vector<std::uint32_t> order(n);
  for (std::size_t i = 0; i < n; ++i)
    order[i] = static_cast<std::uint32_t>(i);
  std::mt19937 random(seed);
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1], order[random() % i]);
  return order;
}

template <class Value>
std::vector<Value> permuted(const std::vector<Value>& values,
                            const std::vector<std::uint32_t>& order)
{
  std::vector<Value> result;
  for (const auto i : order)
    result.push_back(values[i]);
  return result;
}

/// Indices of the points that `is_in` accepts.
template <class Predicate>
std::vector<std::size_t> select(const Points& points, const Predicate& is_in)
{
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_in(points[i]))
      result.push_back(i);
  return result;
}

inline double largest_distance(const Points& a, const Points& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = (a[i] - b[i]).norm();
    largest = d <= largest ? largest : d; // keeps a NaN
  }
  return largest;
}

/// Diagonal of the bounding box.
inline double diagonal(const Points& points)
{
  Eigen::AlignedBox3d box_of_points;
  for (const Vec3& p : points)
    box_of_points.extend(p);
  return box_of_points.diagonal().norm();
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_POINT_CLOUDS_H
