// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Repeated timing, the reference computations that times are divided by, and the memory of this
// process.

#ifndef PCS_BENCHMARK_SUPPORT_MEASURING_H
#define PCS_BENCHMARK_SUPPORT_MEASURING_H

#include <Eigen/Core>
#include <nanoflann.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <sys/resource.h>
#include <vector>

namespace pcs_bench {

using Vec3 = Eigen::Vector3d;

class Timer
{
public:
  double seconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
  }

private:
  std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
};

/// Times of repeated runs [s].
class Timings
{
public:
  void add(double seconds) { m_seconds.push_back(seconds); }
  double best() const { return quantile(0); }
  double median() const { return quantile(0.5); }

private:
  double quantile(double q) const
  {
    if (m_seconds.empty())
      return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> sorted = m_seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1) + 0.5)];
  }

  std::vector<double> m_seconds;
};

template <class F>
Timings repeat(int repetitions, const F& f)
{
  Timings timings;
  for (int r = 0; r < repetitions; ++r) {
    const Timer timer;
    f();
    timings.add(timer.seconds());
  }
  return timings;
}

/// Prevents the compiler from removing computations with unused results.
inline void keep(double value)
{
  volatile double sink = value;
  static_cast<void>(sink);
}

/// Point set interface required by nanoflann.
struct Neighbor_adaptor
{
  const std::vector<Vec3>& points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const
  {
    return points[i][static_cast<Eigen::Index>(d)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const
  {
    return false;
  }
};

/// Queries the `count` nearest points of every point, itself included, in input order with
/// nanoflann's default options. Includes building the tree.
inline void query_neighbors(const std::vector<Vec3>& points, std::size_t count)
{
  using Metric = nanoflann::L2_Simple_Adaptor<double, Neighbor_adaptor>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Neighbor_adaptor, 3, std::uint32_t>;
  const Neighbor_adaptor adaptor{points};
  Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  std::vector<std::uint32_t> indices(count);
  std::vector<double> distances(count);
  double sum = 0;
  for (const Vec3& p : points) {
    tree.knnSearch(p.data(), count, indices.data(), distances.data());
    sum += distances.back();
  }
  keep(sum);
}

/// Memory traffic of moving `n` points with normals: reads two vectors per point and writes two, 96
/// bytes. With links it reads 16 bytes more, the size of the samples of a point and their weights.
class Triad
{
public:
  explicit Triad(std::size_t n, bool has_links = false)
    : m_a(3 * n, 1), m_b(3 * n, 2), m_c(3 * n), m_d(3 * n), m_links(has_links ? 2 * n : 0, 1.5)
  {
  }

  void operator()()
  {
    if (m_links.empty())
      run([](std::size_t) { return 3.0; });
    else
      run([links = m_links.data()](std::size_t i) { return links[2 * i] + links[2 * i + 1]; });
    keep(m_c.back() + m_d.back());
  }

private:
  template <class Factor_at>
  void run(const Factor_at& factor_at)
  {
    const double* a = m_a.data();
    const double* b = m_b.data();
    double* c = m_c.data();
    double* d = m_d.data();
    for (std::size_t i = 0; i < m_a.size() / 3; ++i) {
      const double factor = factor_at(i);
      for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
        c[k] = a[k] + factor * b[k];
        d[k] = b[k] - factor * a[k];
      }
    }
  }

  std::vector<double> m_a, m_b, m_c, m_d, m_links;
};

/// Largest resident size of this process so far. [MB]
inline double peak_megabytes()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  return static_cast<double>(usage.ru_maxrss) / 1e6;
#else
  return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
#endif
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_SUPPORT_MEASURING_H
