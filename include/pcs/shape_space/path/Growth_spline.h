// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Monotone spline through several trees in the order of time.

#ifndef PCS_SHAPE_SPACE_PATH_GROWTH_SPLINE_H
#define PCS_SHAPE_SPACE_PATH_GROWTH_SPLINE_H

#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {
namespace internal {

/// Returns the slopes of F. Fritsch and J. Butland (1984), for which every cubic piece is monotone
/// and stays between its two values.
inline std::vector<double> monotone_slopes(const std::vector<double>& time,
                                           const std::vector<double>& value)
{
  const std::size_t n = time.size();
  std::vector<double> slope(n, 0), step(n - 1), rise(n - 1);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    step[k] = time[k + 1] - time[k];
    rise[k] = (value[k + 1] - value[k]) / step[k];
  }
  if (n == 2)
    return {rise[0], rise[0]};
  for (std::size_t k = 1; k + 1 < n; ++k)
    if (rise[k - 1] * rise[k] > 0) {
      const double a = 2 * step[k] + step[k - 1], b = step[k] + 2 * step[k - 1];
      slope[k] = (a + b) / (a / rise[k - 1] + b / rise[k]);
    }
  const auto at_end = [](double h0, double h1, double d0, double d1) {
    const double s = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (s * d0 <= 0)
      return 0.0;
    return d0 * d1 <= 0 && std::abs(s) > 3 * std::abs(d0) ? 3 * d0 : s;
  };
  slope[0] = at_end(step[0], step[1], rise[0], rise[1]);
  slope[n - 1] = at_end(step[n - 2], step[n - 3], rise[n - 2], rise[n - 3]);
  return slope;
}

inline double cubic(double a, double b, double slope_a, double slope_b, double step, double f)
{
  const double g = 1 - f;
  return g * g * (1 + 2 * f) * a + f * f * (1 + 2 * g) * b +
         f * g * step * (g * slope_a - f * slope_b);
}

/// Replaces values by the closest non-decreasing ones (pool adjacent violators, least squares).
inline void make_rising(std::vector<double>& values)
{
  struct Pool
  {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (const double v : values) {
    pools.push_back({v, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum;
      pools.back().count += last.count;
    }
  }
  std::size_t k = 0;
  for (const Pool& p : pools)
    for (std::size_t i = 0; i < p.count; ++i)
      values[k++] = p.mean();
}

} // namespace internal

/*!
  A path through trees at given times, with continuous speed. Lengths, radii and attachments are
  cubic without overshoot: values that increase from tree to tree increase everywhere, and none
  becomes negative. Orientations are cubic Bezier curves on the rotations (K. Shoemake 1985), by
  repeated slerp. A tree that lacks a branch takes the orientation and attachment of the branch from
  the nearest time at which it exists, so that the branch grows in its own direction.
*/
class Growth_spline
{
public:
  Growth_spline() = default;

  /// Times must increase; there is one tree per time, and at least two. `has[i][b]`: whether tree
  /// `i` has branch `b`. If `is_monotone`, lengths and radii are changed as little as possible so
  /// that none decreases. `scans`: handles of the trees, for the caller.
  Growth_spline(const Orl_layout& layout,
                std::vector<double> times,
                std::vector<Orl_coordinates> trees,
                const std::vector<std::vector<char>>& has,
                bool is_monotone,
                std::vector<std::size_t> scans = std::vector<std::size_t>())
    : m_times(std::move(times)), m_trees(std::move(trees)), m_scans(std::move(scans))
  {
    use_orientations_of_neighbors(layout, has);
    const std::size_t n = m_times.size();
    const auto make = [&](const auto& get, bool is_rising) {
      std::vector<double> values(n);
      for (std::size_t i = 0; i < n; ++i)
        values[i] = get(m_trees[i]);
      if (is_rising)
        internal::make_rising(values);
      for (std::size_t i = 0; i < n; ++i)
        get(m_trees[i]) = values[i];
      const std::vector<double> slopes = internal::monotone_slopes(m_times, values);
      for (std::size_t i = 0; i < n; ++i)
        get(m_slopes[i]) = slopes[i];
    };
    m_slopes = m_trees;
    for (std::size_t e = 0; e < layout.number_of_edges(); ++e) {
      make([e](Orl_coordinates& x) -> double& { return x.length[e]; }, is_monotone);
      make([e](Orl_coordinates& x) -> double& { return x.radius[e]; }, is_monotone);
      find_controls(e);
    }
    for (std::size_t b = 0; b < layout.branches.size(); ++b) {
      make([b](Orl_coordinates& x) -> double& { return x.base_radius[b]; }, is_monotone);
      make([b](Orl_coordinates& x) -> double& { return x.attachment[b]; }, false);
    }
    for (int i = 0; i < 3; ++i)
      make([i](Orl_coordinates& x) -> double& { return x.root[i]; }, false);
  }

  const std::vector<double>& times() const { return m_times; }
  const std::vector<std::size_t>& scans() const { return m_scans; }

  /// Returns the index of the tree at the beginning of the interval that contains `time`, and the
  /// parameter in [0, 1] within this interval.
  std::pair<std::size_t, double> place(double time) const
  {
    const double t = std::min(m_times.back(), std::max(m_times.front(), time));
    std::size_t k = 0;
    while (k + 2 < m_times.size() && m_times[k + 1] <= t)
      ++k;
    return {k, (t - m_times[k]) / (m_times[k + 1] - m_times[k])};
  }

  /// Computes the tree at a time, which is clamped to the interval of all times.
  void at(double time, Orl_coordinates& x) const
  {
    const std::pair<std::size_t, double> where = place(time);
    const std::size_t k = where.first;
    const double f = where.second;
    const double step = m_times[k + 1] - m_times[k];
    const Orl_coordinates &a = m_trees[k], &b = m_trees[k + 1], &da = m_slopes[k],
                          &db = m_slopes[k + 1];
    x = a;
    const auto mix = [&](double p, double q, double dp, double dq) {
      return internal::cubic(p, q, dp, dq, step, f);
    };
    for (int i = 0; i < 3; ++i)
      x.root[i] = mix(a.root[i], b.root[i], da.root[i], db.root[i]);
    for (std::size_t e = 0; e < a.length.size(); ++e) {
      x.length[e] = std::max(0.0, mix(a.length[e], b.length[e], da.length[e], db.length[e]));
      x.radius[e] = std::max(0.0, mix(a.radius[e], b.radius[e], da.radius[e], db.radius[e]));
      x.orientation[e] = f == 0   ? a.orientation[e]
                         : f == 1 ? b.orientation[e]
                                  : bezier(a.orientation[e],
                                           m_after[k].orientation[e],
                                           m_before[k + 1].orientation[e],
                                           b.orientation[e],
                                           f);
    }
    for (std::size_t i = 0; i < a.attachment.size(); ++i) {
      x.base_radius[i] =
          std::max(0.0,
                   mix(a.base_radius[i], b.base_radius[i], da.base_radius[i], db.base_radius[i]));
      x.attachment[i] = mix(a.attachment[i], b.attachment[i], da.attachment[i], db.attachment[i]);
    }
  }

private:
  static Quaternion between(const Quaternion& a, const Quaternion& b, double f)
  {
    Quaternion q = a * rotation_exp(f * rotation_log(a.conjugate() * b));
    q.normalize();
    return q;
  }

  /// Evaluates a Bezier curve by De Casteljau's scheme, with arcs instead of lines.
  static Quaternion bezier(const Quaternion& a,
                           const Quaternion& b,
                           const Quaternion& c,
                           const Quaternion& d,
                           double f)
  {
    const Quaternion ab = between(a, b, f), bc = between(b, c, f), cd = between(c, d, f);
    return between(between(ab, bc, f), between(bc, cd, f), f);
  }

  void use_orientations_of_neighbors(const Orl_layout& layout,
                                     const std::vector<std::vector<char>>& has)
  {
    const std::vector<Orl_coordinates> original = m_trees;
    for (std::size_t i = 0; i < m_trees.size(); ++i)
      for (std::size_t b = 0; b < layout.branches.size(); ++b) {
        if (has[i][b])
          continue;
        std::size_t nearest = i;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t j = 0; j < m_trees.size(); ++j)
          if (has[j][b] && std::abs(m_times[j] - m_times[i]) < least) {
            least = std::abs(m_times[j] - m_times[i]);
            nearest = j;
          }
        const Orl_layout::Branch& branch = layout.branches[b];
        for (std::size_t e = branch.first_edge; e < branch.first_edge + branch.number_of_edges; ++e)
          m_trees[i].orientation[e] = original[nearest].orientation[e];
        m_trees[i].attachment[b] = original[nearest].attachment[b];
      }
  }

  /// Computes the control points a third of an interval before and after each tree, along the mean
  /// speed there.
  void find_controls(std::size_t e)
  {
    const std::size_t n = m_times.size();
    if (m_before.empty())
      m_before = m_after = m_trees;
    std::vector<Vec3> rate(n - 1);
    for (std::size_t k = 0; k + 1 < n; ++k)
      rate[k] =
          rotation_log(m_trees[k].orientation[e].conjugate() * m_trees[k + 1].orientation[e]) /
          (m_times[k + 1] - m_times[k]);
    for (std::size_t k = 0; k < n; ++k) {
      // in the frame of the edge itself; the rotation vector between trees k and k + 1 has the same
      // coordinates in the frames of both trees
      Vec3 speed = Vec3::Zero();
      if (k == 0)
        speed = rate[0];
      else if (k + 1 == n)
        speed = rate[n - 2];
      else {
        const double h0 = m_times[k] - m_times[k - 1], h1 = m_times[k + 1] - m_times[k];
        speed = (h1 * rate[k - 1] + h0 * rate[k]) / (h0 + h1);
      }
      const Quaternion& q = m_trees[k].orientation[e];
      if (k > 0)
        m_before[k].orientation[e] = q * rotation_exp(-(m_times[k] - m_times[k - 1]) / 3 * speed);
      if (k + 1 < n)
        m_after[k].orientation[e] = q * rotation_exp((m_times[k + 1] - m_times[k]) / 3 * speed);
    }
  }

  std::vector<double> m_times;
  std::vector<Orl_coordinates> m_trees, m_slopes, m_before, m_after;
  std::vector<std::size_t> m_scans;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PATH_GROWTH_SPLINE_H
