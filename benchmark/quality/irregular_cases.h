// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Bars and tubes with samplings similar to scans (random, blue noise, graded, noisy, shuffled), and
// the robustness cases.

#ifndef PCS_BENCHMARK_QUALITY_IRREGULAR_CASES_H
#define PCS_BENCHMARK_QUALITY_IRREGULAR_CASES_H

#include <support/deformation_cases.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs_bench {

using pcs_test::Deformation_case;
using pcs_test::Triangle;
using pcs_test::Vec3;

/// SplitMix64. Gives the same numbers on every platform, unlike the distributions of <random>.
class Random
{
public:
  explicit Random(std::uint64_t seed) : m_state(seed) {}

  std::uint64_t bits()
  {
    std::uint64_t z = (m_state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return double(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal distribution (Box and Muller).
  double normal()
  {
    const double r = std::sqrt(-2 * std::log(1 - uniform()));
    return r * std::cos(2 * pcs_test::pi * uniform());
  }
  Vec3 direction()
  {
    Vec3 d;
    for (int c = 0; c < 3; ++c)
      d[c] = normal();
    return d.normalized();
  }
  template <class T>
  void shuffle(std::vector<T>& values)
  {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1], values[bits() % i]);
  }

private:
  std::uint64_t m_state;
};

enum class Sampling_kind { grid, random, blue_noise, gradient, scan_noise, shuffled };

inline const char* name_of(Sampling_kind kind)
{
  switch (kind) {
  case Sampling_kind::grid:
    return "grid";
  case Sampling_kind::random:
    return "random";
  case Sampling_kind::blue_noise:
    return "blue noise";
  case Sampling_kind::gradient:
    return "density 4:1";
  case Sampling_kind::scan_noise:
    return "noise 0.2 h";
  case Sampling_kind::shuffled:
    return "shuffled";
  }
  return "";
}

/// Random points on the triangles of a case, uniform by area.
class Surface_sampler
{
public:
  explicit Surface_sampler(const Deformation_case& shape) : m_shape(shape)
  {
    for (const Triangle& t : shape.triangles) {
      const Vec3 cross = normal(t);
      m_area += 0.5 * cross.norm();
      m_sum.push_back(m_area);
    }
  }

  double area() const { return m_area; }

  /// A point and its unit normal.
  std::pair<Vec3, Vec3> operator()(Random& random) const
  {
    const auto found = std::upper_bound(m_sum.begin(), m_sum.end(), m_area * random.uniform());
    const auto last = static_cast<std::ptrdiff_t>(m_sum.size()) - 1;
    const auto t = m_shape.triangles[std::size_t(std::min(found - m_sum.begin(), last))];
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& p = m_shape.points;
    return {p[t[0]] + u * (p[t[1]] - p[t[0]]) + v * (p[t[2]] - p[t[0]]), normal(t).normalized()};
  }

private:
  Vec3 normal(const Triangle& t) const
  {
    const auto& p = m_shape.points;
    return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
  }

  const Deformation_case& m_shape;
  std::vector<double> m_sum;
  double m_area = 0;
};

/// Accepts points that keep a minimum distance from all points accepted before.
class Dart_board
{
public:
  explicit Dart_board(double distance) : m_distance(distance) {}

  bool accept(const Vec3& p)
  {
    const auto cell = [&](double x) { return std::int64_t(std::floor(x / m_distance)); };
    const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
      return ((x & 0x1fffff) << 42) | ((y & 0x1fffff) << 21) | (z & 0x1fffff);
    };
    const std::int64_t x = cell(p.x()), y = cell(p.y()), z = cell(p.z());
    for (std::int64_t i = x - 1; i <= x + 1; ++i)
      for (std::int64_t j = y - 1; j <= y + 1; ++j)
        for (std::int64_t k = z - 1; k <= z + 1; ++k) {
          const auto found = m_cells.find(key(i, j, k));
          if (found == m_cells.end())
            continue;
          for (const Vec3& q : found->second)
            if ((q - p).squaredNorm() < m_distance * m_distance)
              return false;
        }
    m_cells[key(x, y, z)].push_back(p);
    return true;
  }

private:
  double m_distance;
  std::unordered_map<std::int64_t, std::vector<Vec3>> m_cells;
};

/// Resamples the shape of `grid`, a case of a bar or tube along z, by the same number of points.
/// The result has no triangles.
inline Deformation_case resample(const Deformation_case& grid, Sampling_kind kind)
{
  if (kind == Sampling_kind::grid)
    return grid;
  Deformation_case c = grid;
  c.triangles.clear();
  c.is_closed = false;
  Random random(12345);
  if (kind == Sampling_kind::shuffled) {
    std::vector<std::uint32_t> order(c.points.size());
    for (std::size_t i = 0; i < order.size(); ++i)
      order[i] = static_cast<std::uint32_t>(i);
    random.shuffle(order);
    std::vector<std::uint32_t> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      c.points[i] = grid.points[order[i]];
      place[order[i]] = static_cast<std::uint32_t>(i);
    }
    for (auto& handle : c.handles)
      for (auto& i : handle)
        i = place[i];
    return c;
  }
  // The clamps are regions of space, bounded by the handles of the grid.
  double low = 0, high = grid.length;
  for (const auto i : grid.handles[0])
    low = std::max(low, grid.points[i].z());
  for (const auto i : grid.handles[1])
    high = std::min(high, grid.points[i].z());
  const Surface_sampler sampler(grid);
  const std::size_t n = grid.points.size();
  const double spacing = std::sqrt(sampler.area() / double(n));
  // Random disks that fill the surface are 0.83 spacings apart; a distance of 0.76 spacings needs
  // only moderately many attempts.
  const bool is_blue = kind == Sampling_kind::blue_noise || kind == Sampling_kind::scan_noise;
  Dart_board board(0.76 * spacing);
  c.points.clear();
  while (c.points.size() < n) {
    auto [p, normal] = sampler(random);
    if (kind == Sampling_kind::gradient && random.uniform() > 1 - 0.75 * p.z() / grid.length)
      continue;
    if (is_blue && !board.accept(p))
      continue;
    if (kind == Sampling_kind::scan_noise)
      p += 0.2 * spacing * random.normal() * normal;
    c.points.push_back(p);
  }
  c.transforms = grid.transforms;
  pcs_test::select_ends(c, low, high);
  return c;
}

/// T6: the bent bar with jitter of 0.3 spacings, 2 % outliers at up to 5 spacings, in random order.
inline Deformation_case rough_bar_bend_120()
{
  Deformation_case c = resample(pcs_test::bar_bend_120(), Sampling_kind::shuffled);
  c.name = "T6 rough bar";
  const double spacing = 0.05; // of the grid
  Random random(6);
  for (std::size_t i = 0; i < c.points.size(); ++i)
    if (random.uniform() < 0.02)
      c.points[i] += 5 * spacing * random.uniform() * random.direction();
    else
      for (int k = 0; k < 3; ++k)
        c.points[i][k] += 0.3 * spacing * random.uniform(-1, 1);
  pcs_test::select_ends(c, .3, 6 - .3);
  return c;
}

/// T6: two parallel sheets 1.5 spacings apart, joined along one end. The lower one is fixed at both
/// ends, the free end of the upper one is lifted. In the exact solution the lower sheet does not
/// move.
struct Sheets_case : Deformation_case
{
  std::vector<char> is_lower; ///< per point
};

inline Sheets_case two_sheets(double jitter)
{
  Sheets_case c;
  c.name = "T6 two sheets";
  const int across = 40, along = 100;
  const double h = 0.01, gap = 1.5 * h;
  Random random(66);
  c.handles.assign(3, {});
  const auto add = [&](double x, double y, double z, bool is_lower) {
    Vec3 p(x * h, y * h, z);
    for (int k = 0; k < 3; ++k)
      p[k] += jitter * h * random.uniform(-1, 1);
    const auto i = static_cast<std::uint32_t>(c.points.size());
    c.points.push_back(p);
    c.is_lower.push_back(is_lower ? 1 : 0);
    if (x < 0)
      c.handles[0].push_back(i); // the joint
    else if (x > along - 5)
      c.handles[is_lower ? 1 : 2].push_back(i);
  };
  for (int j = 0; j <= across; ++j) {
    for (int i = -5; i <= along; ++i) {
      add(i, j, 0, true);
      add(i, j, gap, false);
    }
    add(-6, j, 0.5 * gap, true); // closes the end
  }
  c.length = along * h;
  c.transforms = {pcs::Similarity(),
                  pcs::Similarity(),
                  pcs::Similarity::from_translation(Vec3(-0.1 * c.length, 0, 0.3 * c.length))};
  return c;
}

/// T2's bar with both ends turned, about different axes.
inline Deformation_case bar_two_axes()
{
  Deformation_case c = pcs_test::bar_bend_120();
  c.name = "two axes 75 x, 90 y";
  const Vec3 turns[2] = {Vec3(75, 0, 0) * pcs_test::pi / 180, Vec3(0, 90, 0) * pcs_test::pi / 180};
  const Vec3 centers[2] = {Vec3(0, 0, .3), Vec3(0, 0, 5.7)};
  for (std::size_t k = 0; k < 2; ++k)
    c.transforms[k] = pcs::Similarity::about(pcs::Similarity::from_turn(turns[k]), centers[k]);
  c.exact = nullptr;
  return c;
}

/// T2's bar with one end turned by 400 degrees about z, then by 90 about x.
inline Deformation_case bar_400_then_90()
{
  Deformation_case c = pcs_test::bar_bend_120();
  c.name = "400 z, then 90 x";
  const pcs::Similarity turn = pcs::Similarity::from_turn(Vec3(90, 0, 0) * pcs_test::pi / 180) *
                               pcs::Similarity::from_turn(Vec3(0, 0, 400) * pcs_test::pi / 180);
  c.transforms[1] = pcs::Similarity::about(turn, Vec3(0, 0, 5.7));
  c.exact = nullptr;
  return c;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_IRREGULAR_CASES_H
