// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Geometric median and Frechet mean of trees.

#ifndef PCS_SHAPE_SPACE_STATISTICS_MEAN_TREE_H
#define PCS_SHAPE_SPACE_STATISTICS_MEAN_TREE_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/embedding/mean_rotation.h>
#include <pcs/shape_space/model/Orl_coordinates.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace shape_space {

namespace internal {

/// Returns the geometric median: the position with the least sum of weighted distances (Weiszfeld
/// 1937; Vardi, Zhang 2000 at the data points).
inline Vec3 l1_mean_position(const std::vector<Vec3>& p, const std::vector<double>& w)
{
  Vec3 mean = Vec3::Zero();
  double total = 0, extent = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    mean += w[i] * p[i];
    total += w[i];
    extent = std::max(extent, (p[i] - p[0]).norm());
  }
  mean /= total;
  constexpr int number_of_steps = 1000;
  for (int k = 0; k < number_of_steps && extent > 0; ++k) {
    Vec3 sum = Vec3::Zero(), pull = Vec3::Zero();
    double scale = 0, here = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double d = (p[i] - mean).norm();
      if (d <= 1e-14 * extent) {
        here += w[i];
        continue;
      }
      sum += w[i] / d * p[i];
      pull += w[i] / d * (p[i] - mean);
      scale += w[i] / d;
    }
    if (!(scale > 0) || pull.norm() <= std::max(here, 1e-13 * total))
      break;
    const double keep = std::min(1.0, here / pull.norm());
    const Vec3 next = (1 - keep) * sum / scale + keep * mean;
    const double step = (next - mean).norm();
    mean = next;
    if (step <= 1e-15 * extent)
      break;
  }
  return mean;
}

/// Weighted means or medians of numbers, radii, rotations and positions, one value per tree.
class Weighted_mean
{
public:
  Weighted_mean(const std::vector<double>& weights, Tree_mean kind)
    : m_weights(weights),
      m_is_median(kind == Tree_mean::median),
      m_is_within(*std::min_element(weights.begin(), weights.end()) >= 0)
  {
    for (const double w : weights)
      m_total += w;
  }

  double operator()(const std::vector<double>& values) const
  {
    if (m_is_median)
      return weighted_median(values, m_weights);
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      sum += m_weights[i] * values[i];
    return sum / m_total;
  }

  /// Returns the mean radius [L]. If a weight is negative and the mean has the edge or branch, the
  /// result is at least a hundredth of the least positive value.
  double radius(const std::vector<double>& values, bool is_present) const
  {
    constexpr double least_fraction = 0.01;
    double least = 0;
    for (const double r : values)
      if (!m_is_within && is_present && r > 0 && (!(least > 0) || least_fraction * r < least))
        least = least_fraction * r;
    return std::max(least, (*this)(values));
  }

  Quaternion rotation(const std::vector<Quaternion>& q) const
  {
    return m_is_median ? l1_mean_rotation(q, m_weights) : l2_mean_rotation(q, m_weights);
  }

  Vec3 position(const std::vector<Vec3>& p) const
  {
    if (m_is_median)
      return l1_mean_position(p, m_weights);
    Vec3 result = Vec3::Zero();
    for (std::size_t i = 0; i < p.size(); ++i)
      result += m_weights[i] / m_total * p[i];
    return result;
  }

private:
  const std::vector<double>& m_weights;
  bool m_is_median, m_is_within;
  double m_total = 0;
};

/// Computes the mean of edge `e` over the trees.
inline void set_mean_edge(const std::vector<const Orl_coordinates*>& trees,
                          const Weighted_mean& mean,
                          std::size_t e,
                          Orl_coordinates& x)
{
  std::vector<double> values(trees.size());
  std::vector<Quaternion> q(trees.size());
  for (std::size_t i = 0; i < trees.size(); ++i)
    values[i] = trees[i]->length[e];
  x.length[e] = std::max(0.0, mean(values));
  for (std::size_t i = 0; i < trees.size(); ++i)
    values[i] = trees[i]->radius[e];
  x.radius[e] = mean.radius(values, x.length[e] > 0);
  for (std::size_t i = 0; i < trees.size(); ++i)
    q[i] = trees[i]->orientation[e];
  x.orientation[e] = mean.rotation(q);
}

/// Computes the mean base radius and attachment of branch `b`. The lengths of `x` must be set.
inline void set_mean_base(const Orl_layout& layout,
                          const std::vector<const Orl_coordinates*>& trees,
                          const Weighted_mean& mean,
                          std::size_t b,
                          Orl_coordinates& x)
{
  std::vector<double> values(trees.size());
  for (std::size_t i = 0; i < trees.size(); ++i)
    values[i] = trees[i]->base_radius[b];
  const std::size_t first = layout.branches[b].first_edge;
  x.base_radius[b] = mean.radius(values, x.length[first] > 0);
  for (std::size_t i = 0; i < trees.size(); ++i)
    values[i] = trees[i]->attachment[b];
  const std::size_t p = layout.branches[b].parent;
  const double last = p == none ? 0 : static_cast<double>(layout.branches[p].number_of_edges);
  x.attachment[b] = std::min(last, std::max(0.0, mean(values)));
}

} // namespace internal

/*!
  Computes the mean of trees with weights, coordinate by coordinate. `median` requires weights
  `>= 0`. If all values of an interval are medians, its middle is taken. With `frechet`, weights may
  be negative if their sum is positive. Lengths are then limited to at least 0, and radii to at
  least a hundredth of the least positive radius of the trees.
*/
template <class ConcurrencyTag>
Orl_coordinates mean_tree(const Orl_layout& layout,
                          const std::vector<const Orl_coordinates*>& trees,
                          const std::vector<double>& weights,
                          Tree_mean kind)
{
  const std::size_t n = layout.number_of_edges(), m = layout.branches.size();
  const internal::Weighted_mean mean(weights, kind);
  Orl_coordinates x;
  x.orientation.resize(n);
  x.length.resize(n);
  x.radius.resize(n);
  x.base_radius.resize(m);
  x.attachment.resize(m);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t e) { internal::set_mean_edge(trees, mean, e, x); },
      64);
  for (std::size_t b = 0; b < m; ++b)
    internal::set_mean_base(layout, trees, mean, b, x);
  std::vector<Vec3> roots;
  for (const Orl_coordinates* tree : trees)
    roots.push_back(tree->root);
  x.root = mean.position(roots);
  return x;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_MEAN_TREE_H
