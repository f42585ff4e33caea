// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Elastic matching of curves by square-root velocities and dynamic programming.
//
// With unit tangents u [-] and lengths L [L], a curve has the square-root velocity q = sqrt(L) u
// (A. Srivastava, E. Klassen, S. H. Joshi, I. H. Jermyn, IEEE TPAMI 33, 2011). The squared distance
// of two curves is minimised over the reparametrisations g of curve 2, which increase from 0 to 1
// on [0, 1],
//
//   E(g) = int |q1 - sqrt(g') q2(g)|^2 = L1 + L2 - 2 sqrt(L1 L2) M(g),                        [L]
//   M(g) = int sqrt(g') u1 . u2(g).                                                           [-]
//
// M is at most 1, so that (sqrt L1 - sqrt L2)^2 bounds the energy from below. M is maximised by
// dynamic programming over a grid of n by n samples, with equal weights of all samples of curve 1,
//
//   B(i, j) = max_{a, b} (B(i-a, j-b) + sqrt(b/a) sum_{0 <= x < a} u1(i-a+x) . u2(j-b + x b/a)),
//   B(0, 0) = 0,   M = B(n-1, n-1) / (n-1).
//
// Products are interpolated linearly between samples of curve 2. The steps a, b are coprime and at
// most s, so that 1/s <= g' <= s.

#ifndef PCS_SHAPE_SPACE_MATCHING_ELASTIC_CURVES_H
#define PCS_SHAPE_SPACE_MATCHING_ELASTIC_CURVES_H

#include <pcs/internal/lanes.h>
#include <pcs/shape_space/model/Branch_paths.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace pcs {
namespace shape_space {

/// Unit tangents of a curve at equidistant positions, as columns, and the length of the curve. The
/// square-root velocity is the tangent times the root of the length.
struct Sampled_curve
{
  Eigen::Matrix3Xd tangents;
  double length = 0;              ///< [L]
  Vec3 direction = Vec3::UnitZ(); ///< unit vector of the mean tangent
  double spread = 0;              ///< largest angle between `direction` and a tangent [rad]
  double cosine = 1, sine = 0;    ///< of `spread`
};

/// Returns the point at arc length `s` on a polyline. [L]
inline Vec3 point_at(const Rooted_tree& tree, const Branch_path& path, double s)
{
  const auto it = std::upper_bound(path.arc.begin(), path.arc.end(), s);
  const auto behind = static_cast<std::size_t>(it - path.arc.begin());
  const std::size_t k = std::min(path.arc.size() - 1, std::max<std::size_t>(1, behind));
  const double length = path.arc[k] - path.arc[k - 1];
  const double f = std::min(1.0, std::max(0.0, (s - path.arc[k - 1]) / length));
  return (1 - f) * tree.points[path.nodes[k - 1]] + f * tree.points[path.nodes[k]];
}

/// Samples a path up to the node `last`. Tangents are differences over two steps. Like the
/// published spline [Aiteanu 2022], they smooth kinks shorter than the step.
inline Sampled_curve
sample_curve(const Rooted_tree& tree, const Branch_path& path, std::size_t n, std::size_t last)
{
  Sampled_curve curve;
  const auto size = static_cast<Eigen::Index>(n);
  curve.length = path.arc[last];
  Eigen::Matrix3Xd places(3, size);
  for (Eigen::Index i = 0; i < size; ++i)
    places.col(i) =
        point_at(tree, path, curve.length * static_cast<double>(i) / static_cast<double>(n - 1));
  curve.tangents.resize(3, size);
  Vec3 mean = Vec3::Zero();
  for (Eigen::Index i = 0; i < size; ++i) {
    Vec3 t = places.col(std::min(size - 1, i + 1)) - places.col(std::max<Eigen::Index>(0, i - 1));
    if (t.squaredNorm() <= 0 || !(t.norm() > 0)) // the curve reverses its direction
      t = i > 0 ? Vec3(curve.tangents.col(i - 1)) : Vec3(places.col(size - 1) - places.col(0));
    curve.tangents.col(i) = t.norm() > 0 ? Vec3(t.normalized()) : Vec3(Vec3::UnitZ());
    mean += curve.tangents.col(i);
  }
  curve.direction = mean.norm() > 1e-12 * static_cast<double>(n) ? Vec3(mean.normalized())
                                                                 : Vec3(curve.tangents.col(0));
  double smallest = 1;
  for (Eigen::Index i = 0; i < size; ++i)
    smallest = std::min(smallest, curve.direction.dot(curve.tangents.col(i)));
  curve.cosine = std::max(-1.0, smallest);
  curve.spread = std::acos(curve.cosine);
  curve.sine = std::sqrt(1 - curve.cosine * curve.cosine);
  return curve;
}

inline Sampled_curve sample_curve(const Rooted_tree& tree, const Branch_path& path, std::size_t n)
{
  return sample_curve(tree, path, n, path.nodes.size() - 1);
}

/// Steps of the grid, coprime pairs up to 3 or up to 6.
struct Slope
{
  std::uint8_t a, b;
};
using Slopes = std::vector<Slope>;
inline Slopes make_slopes(int largest)
{
  Slopes slopes{{1, 1}}; // first, so that ties keep the linear correspondence
  for (int a = 1; a <= largest; ++a)
    for (int b = 1; b <= largest; ++b)
      if (std::gcd(a, b) == 1 && a != b)
        slopes.push_back({static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
  return slopes;
}

/*!
  Matches curve 2 to curve 1, as stated at the head of this file.

  Costs O(n^2 sum a) for `n` samples, with the sum over all steps up to `s = largest_step`.
*/
class Elastic_matcher
{
public:
  /// `largest_step`: of `make_slopes()`, at most 6.
  Elastic_matcher(std::size_t number_of_samples, int largest_step)
    : m_size(number_of_samples),
      m_steepest(static_cast<std::size_t>(largest_step)),
      m_slopes(make_slopes(largest_step)),
      m_stride(margin + (number_of_samples + lanes - 1) / lanes * lanes),
      m_turned(Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(m_stride - margin), 3)),
      m_dots(number_of_samples * m_stride, 0),
      m_best(number_of_samples * m_stride, -std::numeric_limits<double>::infinity()),
      m_gamma(number_of_samples)
  {
    for (const Slope& s : m_slopes) {
      const double root = std::sqrt(static_cast<double>(s.b) / static_cast<double>(s.a));
      m_weights.emplace_back();
      for (int x = 0; x < s.a; ++x) {
        const double f = static_cast<double>(x * s.b % s.a) / static_cast<double>(s.a);
        m_weights.back().push_back({root * (1 - f), root * f});
      }
    }
  }

  std::size_t number_of_samples() const { return m_size; }

  /// Least gain of a better step: rounding must not decide between equal steps along straight
  /// pieces. [-]
  static constexpr double least_gain = 1e-9;

  /// Returns the maximum of `M`, but at least 0, with curve 2 rotated by `rotation`.
  double
  operator()(const Sampled_curve& one, const Sampled_curve& two, const Eigen::Matrix3d& rotation)
  {
    const std::size_t n = m_size;
    m_turned.topRows(static_cast<Eigen::Index>(n)).noalias() =
        two.tangents.transpose() * rotation.transpose();
    for (std::size_t i = 0; i < n; ++i)
      find_dots(i, one.tangents.col(static_cast<Eigen::Index>(i)));
    std::fill(m_best.begin(), m_best.end(), -std::numeric_limits<double>::infinity());
    m_best[margin] = 0;
    for (std::size_t i = 1; i < n; ++i)
      for (std::size_t k = 0; k < m_slopes.size(); ++k)
        if (m_slopes[k].a <= i)
          take_step(i, k);
    return std::max(0.0, m_best[(n - 1) * m_stride + margin + n - 1] / static_cast<double>(n - 1));
  }

  /// Returns, after a match, the positions on curve 2 of the samples of curve 1, as fractions of
  /// the length, increasing from 0 to 1.
  const std::vector<double>& gamma()
  {
    const std::size_t n = m_size;
    std::size_t i = n - 1, j = n - 1;
    m_gamma[i] = static_cast<double>(j);
    while (i > 0) {
      const Slope s = step_to(i, j);
      for (std::size_t x = 1; x <= s.a; ++x)
        m_gamma[i - x] = static_cast<double>(j) - static_cast<double>(x * s.b) / s.a;
      i -= s.a;
      j -= s.b;
    }
    for (double& g : m_gamma)
      g = std::max(0.0, g / static_cast<double>(n - 1));
    return m_gamma;
  }

private:
  /// Updates the cells of row `i` by the step `k`; inner loops run along rows of the tables. Cells
  /// that no path of such steps from corner to corner can reach are left out.
  void take_step(std::size_t i, std::size_t k)
  {
    const std::size_t n = m_size, a = m_slopes[k].a, b = m_slopes[k].b, rest = n - 1 - i;
    const std::size_t behind = m_steepest * rest; // columns that the remaining steps can pass
    const std::size_t first =
        std::max({b, (i + m_steepest - 1) / m_steepest, n - 1 > behind ? n - 1 - behind : 0});
    const std::size_t last = std::min(m_steepest * i, n - 1 - (rest + m_steepest - 1) / m_steepest);
    if (first > last)
      return;
    const Span span{i, first / lanes * lanes, last + 1};
    switch (a) {
    case 1:
      return take_step<1>(span, k);
    case 2:
      return take_step<2>(span, k);
    case 3:
      return take_step<3>(span, k);
    default:
      return take_step<6>(span, k);
    }
  }

  /// A range of cells of a row; `begin` is a multiple of the number of lanes.
  struct Span
  {
    std::size_t row, begin, end;
  };

  /// Computes row `i` of the products of tangents.
  void find_dots(std::size_t i, const Vec3& tangent)
  {
    const auto size = static_cast<std::size_t>(m_turned.rows());
    const double *const x = m_turned.data(), *const y = x + size, *const z = y + size;
    double* const to = m_dots.data() + i * m_stride + margin;
    for (std::size_t j = 0; j < size; j += lanes) {
      Lanes a, b, c;
      pcs::internal::load(x + j, a);
      pcs::internal::load(y + j, b);
      pcs::internal::load(z + j, c);
      pcs::internal::store(a * tangent.x() + b * tangent.y() + c * tangent.z(), to + j);
    }
  }

  /// Updates a span of cells by a step over at most `Most` rows, so that gains stay in registers.
  /// For `Most` up to 3, the step is over exactly `Most` rows.
  template <std::size_t Most>
  void take_step(const Span& span, std::size_t k)
  {
    const std::size_t b = m_slopes[k].b, a = Most > 3 ? m_slopes[k].a : Most;
    std::array<const double*, Most> row;
    std::array<double, Most> w0, w1;
    for (std::size_t x = 0; x < a; ++x) {
      row[x] = m_dots.data() + (span.row - a + x) * m_stride + margin + x * b / a - b;
      w0[x] = m_weights[k][x][0];
      w1[x] = m_weights[k][x][1];
    }
    const double* const from = m_best.data() + (span.row - a) * m_stride + margin - b;
    double* const to = m_best.data() + span.row * m_stride + margin;
    for (std::size_t j = span.begin; j < span.end; j += lanes) {
      Lanes value, gain, next, best;
      pcs::internal::load(row[0] + j, gain); // the first position of a step is a node of the grid
      gain = gain * w0[0];
      for (std::size_t x = 1; x < a; ++x) {
        pcs::internal::load(row[x] + j, value);
        pcs::internal::load(row[x] + j + 1, next);
        gain += value * w0[x] + next * w1[x];
      }
      pcs::internal::load(from + j, value);
      value = value + gain;
      pcs::internal::load(to + j, best);
      pcs::internal::select_less(best, value, value, best, best);
      pcs::internal::store(best, to + j);
    }
  }

  /// Returns the step that gave the value of a cell, found by the same comparison.
  Slope step_to(std::size_t i, std::size_t j) const
  {
    double best = -std::numeric_limits<double>::infinity();
    Slope result = m_slopes[0];
    for (std::size_t k = 0; k < m_slopes.size(); ++k) {
      const std::size_t a = m_slopes[k].a, b = m_slopes[k].b;
      if (a > i || b > j)
        continue;
      const double* const row = m_dots.data() + (i - a) * m_stride + margin + j - b;
      double gain = m_weights[k][0][0] * row[0];
      for (std::size_t x = 1; x < a; ++x) {
        const double* const at = row + x * m_stride + x * b / a;
        gain += m_weights[k][x][0] * at[0] + m_weights[k][x][1] * at[1];
      }
      const double value = m_best[(i - a) * m_stride + margin + j - b] + gain;
      if (value > best + least_gain) {
        best = value;
        result = m_slopes[k];
      }
    }
    return result;
  }

  static constexpr std::size_t lanes = 2;
  static constexpr std::size_t margin = 6; // left of each row: steps that begin there gain nothing
  using Lanes = pcs::internal::Double2;

  std::size_t m_size, m_steepest;
  Slopes m_slopes;
  std::size_t m_stride;      // of rows
  Eigen::MatrixX3d m_turned; // tangents of curve 2
  std::vector<std::vector<std::array<double, 2>>>
      m_weights; // per slope and row of the step: for a cell and the next one
  std::vector<double> m_dots, m_best;
  std::vector<double> m_gamma;
};

/// Returns the value at `t` in [0, 1] of a function given at equidistant positions.
inline double value_at(const std::vector<double>& gamma, double t)
{
  const double x = std::min(1.0, std::max(0.0, t)) * static_cast<double>(gamma.size() - 1);
  const std::size_t i = std::min(gamma.size() - 2, static_cast<std::size_t>(x));
  const double f = x - static_cast<double>(i);
  return (1 - f) * gamma[i] + f * gamma[i + 1];
}

/// Returns the inverse of such a function where it increases from 0 to 1.
inline double inverse_at(const std::vector<double>& gamma, double y)
{
  const auto it = std::upper_bound(gamma.begin(), gamma.end(), y);
  if (it == gamma.begin())
    return 0;
  if (it == gamma.end())
    return 1;
  const auto i = static_cast<std::size_t>(it - gamma.begin());
  const double width = gamma[i] - gamma[i - 1];
  const double f = width > 0 ? (y - gamma[i - 1]) / width : 0;
  return (static_cast<double>(i - 1) + f) / static_cast<double>(gamma.size() - 1);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_MATCHING_ELASTIC_CURVES_H
