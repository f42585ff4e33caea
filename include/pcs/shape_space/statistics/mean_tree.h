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

/// The place with the least sum of weighted distances (Weiszfeld 1937; Vardi, Zhang 2000 at the
/// data points).
inline Vec3 l1_mean_place(const std::vector<Vec3>& p, const std::vector<double>& w)
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

} // namespace internal

/*!
  The mean of trees with weights, coordinate by coordinate. `median` wants weights `>= 0`; of an
  interval of medians it takes the middle. With `frechet` weights may be negative as long as their
  sum is positive: lengths stay at least 0, radii a hundredth of the least one.
*/
template <class ConcurrencyTag>
Orl_coordinates mean_tree(const Orl_layout& layout,
                          const std::vector<const Orl_coordinates*>& trees,
                          const std::vector<double>& weights,
                          Tree_mean kind)
{
  const std::size_t n = layout.number_of_edges(), m = layout.branches.size();
  const bool is_sum = kind == Tree_mean::median;
  double total = 0;
  for (const double w : weights)
    total += w;
  const auto mean_of = [&](const std::vector<double>& values) {
    if (is_sum)
      return weighted_median(values, weights);
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      sum += weights[i] * values[i];
    return sum / total;
  };
  const bool is_within = *std::min_element(weights.begin(), weights.end()) >= 0;
  // of an edge or branch that is there; beyond the trees it keeps a share of the least radius that
  // it has in one
  const auto mean_radius = [&](const std::vector<double>& values, bool is_there) {
    constexpr double least_share = 0.01;
    double least = 0;
    for (const double r : values)
      if (!is_within && is_there && r > 0 && (!(least > 0) || least_share * r < least))
        least = least_share * r;
    return std::max(least, mean_of(values));
  };
  Orl_coordinates x;
  x.orientation.resize(n);
  x.length.resize(n);
  x.radius.resize(n);
  x.base_radius.resize(m);
  x.attachment.resize(m);
  pcs::internal::for_each_index<ConcurrencyTag>(
      n,
      [&](std::size_t e) {
        std::vector<double> values(trees.size());
        std::vector<Quaternion> q(trees.size());
        for (std::size_t i = 0; i < trees.size(); ++i)
          values[i] = trees[i]->length[e];
        x.length[e] = std::max(0.0, mean_of(values));
        for (std::size_t i = 0; i < trees.size(); ++i)
          values[i] = trees[i]->radius[e];
        x.radius[e] = mean_radius(values, x.length[e] > 0);
        for (std::size_t i = 0; i < trees.size(); ++i)
          q[i] = trees[i]->orientation[e];
        x.orientation[e] = is_sum ? l1_mean_rotation(q, weights) : l2_mean_rotation(q, weights);
      },
      64);
  for (std::size_t b = 0; b < m; ++b) {
    std::vector<double> values(trees.size());
    for (std::size_t i = 0; i < trees.size(); ++i)
      values[i] = trees[i]->base_radius[b];
    const std::size_t first = layout.branches[b].first_edge;
    x.base_radius[b] = mean_radius(values, x.length[first] > 0);
    for (std::size_t i = 0; i < trees.size(); ++i)
      values[i] = trees[i]->attachment[b];
    const std::size_t p = layout.branches[b].parent;
    const double last = p == none ? 0 : static_cast<double>(layout.branches[p].number_of_edges);
    x.attachment[b] = std::min(last, std::max(0.0, mean_of(values)));
  }
  std::vector<Vec3> roots;
  for (const Orl_coordinates* tree : trees)
    roots.push_back(tree->root);
  if (is_sum)
    x.root = internal::l1_mean_place(roots, weights);
  else {
    x.root = Vec3::Zero();
    for (std::size_t i = 0; i < roots.size(); ++i)
      x.root += weights[i] / total * roots[i];
  }
  return x;
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_STATISTICS_MEAN_TREE_H
