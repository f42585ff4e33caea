// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sampling by an adaptive octree.

#ifndef PCS_DEFORMATION_BODY_OCTREE_SAMPLES_H
#define PCS_DEFORMATION_BODY_OCTREE_SAMPLES_H

#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/spatial_order.h>

#include <CGAL/tags.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <queue>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

/// A point counts as nearer than another only if the ratio of the squared distances is below this
/// value. On grids, several points are equally near to a centroid, and rounding must not select
/// one.
constexpr double by_far = 1 - 1e-6;
/// Cells with at most this number of leaves, on average, are halved instead of split into octants.
/// Octants of a surface have a quarter of the points of their cell: if only some of the smallest
/// cells were split, the spacing of the samples would vary by a factor of two. Chosen among 4 to 64
/// on the shapes of benchmark/quality. [count]
constexpr std::size_t halved_cell_size = 16;

namespace internal {

/// Consecutive points of one octree cell.
struct Octree_range
{
  std::size_t begin, end;
  std::size_t size() const { return end - begin; }
};

/// Returns the non-empty octants of a cell, which are contiguous in the spatial order. If there are
/// fewer than two, returns two halves of the cell.
inline std::vector<Octree_range> split_range(const std::vector<Eigen::Vector3d>& points,
                                             const Octree_range& range)
{
  std::vector<Octree_range> children;
  if (range.size() > neighborhood::octree_leaf_size) {
    const auto at = [&](std::size_t i) -> const Eigen::Vector3d& { return points[i]; };
    const neighborhood::Octree_cell cell(range.begin, range.end, at);
    std::size_t begin = range.begin;
    for (std::size_t i = begin + 1; i <= range.end; ++i)
      if (i == range.end || cell.octant(points[i]) != cell.octant(points[begin])) {
        children.push_back({begin, i});
        begin = i;
      }
  }
  if (children.size() < 2) {
    const std::size_t middle = range.begin + range.size() / 2;
    children = {{range.begin, middle}, {middle, range.end}};
  }
  return children;
}

/// Divides a cell across its longest side into halves with the same number of points, and changes
/// their order. On grids, coordinates and sides that differ by rounding count as equal.
inline std::vector<Octree_range> halve_range(const std::vector<Eigen::Vector3d>& points,
                                             const Octree_range& range,
                                             std::vector<std::uint32_t>& order)
{
  Eigen::Vector3d low = points[order[range.begin]], high = low;
  for (std::size_t k = range.begin + 1; k < range.end; ++k) {
    low = low.cwiseMin(points[order[k]]);
    high = high.cwiseMax(points[order[k]]);
  }
  const Eigen::Vector3d sides = high - low;
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (by_far * sides[c] > sides[axis])
      axis = c;
  constexpr double number_of_steps = 1 << 16; // along the longest side
  std::vector<std::pair<double, std::uint32_t>> steps;
  steps.reserve(range.size());
  for (std::size_t k = range.begin; k < range.end; ++k)
    steps.emplace_back(
        std::round(number_of_steps * ((points[order[k]][axis] - low[axis]) / sides[axis])),
        order[k]);
  const std::size_t half = range.size() / 2;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(half), steps.end());
  for (std::size_t k = 0; k < steps.size(); ++k)
    order[range.begin + k] = steps[k].second;
  return {{range.begin, range.begin + half}, {range.begin + half, range.end}};
}

/// Returns the point nearest to the centroid of a leaf.
inline std::uint32_t central_point(const std::vector<Eigen::Vector3d>& points,
                                   const Octree_range& leaf,
                                   const std::vector<std::uint32_t>& order)
{
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (std::size_t k = leaf.begin; k < leaf.end; ++k)
    centroid += points[order[k]];
  centroid /= static_cast<double>(leaf.size());
  std::uint32_t nearest = order[leaf.begin];
  for (std::size_t k = leaf.begin + 1; k < leaf.end; ++k)
    if ((points[order[k]] - centroid).squaredNorm() <
        by_far * (points[nearest] - centroid).squaredNorm())
      nearest = order[k];
  return nearest;
}

} // namespace internal

/*!
  Returns the indices of exactly `min(number_of_samples, n)` points, in increasing order. The leaf
  with most points is split until there are enough leaves, so dense parts get more samples. Leaves
  are split into octants; for even spacing, small ones into halves with equal numbers of points, see
  `halved_cell_size`. The sample of a leaf is the point nearest to its centroid. The result is
  deterministic and depends on the positions only. O(n log n).
  \param points distinct points, in the order of `neighborhood::spatial_order()`
  \param is_even whether small leaves are split into halves
*/
template <class ConcurrencyTag = CGAL::Sequential_tag>
std::vector<std::uint32_t> octree_samples(const std::vector<Eigen::Vector3d>& points,
                                          std::size_t number_of_samples,
                                          bool is_even = false)
{
  using internal::Octree_range;
  const std::size_t n = points.size();
  std::vector<std::uint32_t> samples;
  if (number_of_samples >= n) {
    samples.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      samples[i] = static_cast<std::uint32_t>(i);
    return samples;
  }
  const auto is_smaller = [](const Octree_range& a, const Octree_range& b) {
    return a.size() != b.size() ? a.size() < b.size() : a.begin > b.begin;
  };
  std::priority_queue<Octree_range, std::vector<Octree_range>, decltype(is_smaller)> leaves(
      is_smaller);
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  const std::size_t largest_halved = is_even ? halved_cell_size * n / number_of_samples : 0;
  leaves.push({0, n});
  while (leaves.size() < number_of_samples) {
    const Octree_range fullest = leaves.top();
    leaves.pop();
    std::vector<Octree_range> children = fullest.size() > largest_halved
                                             ? internal::split_range(points, fullest)
                                             : internal::halve_range(points, fullest, order);
    // The last split may give too many leaves. Adjacent leaves are joined, smallest pair first.
    while (leaves.size() + children.size() > number_of_samples) {
      std::size_t best = 0;
      for (std::size_t c = 1; c + 1 < children.size(); ++c)
        if (children[c + 1].end - children[c].begin < children[best + 1].end - children[best].begin)
          best = c;
      children[best].end = children[best + 1].end;
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(best) + 1);
    }
    for (const Octree_range& child : children)
      leaves.push(child);
  }
  std::vector<Octree_range> ranges;
  for (; !leaves.empty(); leaves.pop())
    ranges.push_back(leaves.top());
  samples.resize(ranges.size());
  pcs::internal::for_each_index<ConcurrencyTag>(
      ranges.size(),
      [&](std::size_t s) { samples[s] = internal::central_point(points, ranges[s], order); },
      64);
  std::sort(samples.begin(), samples.end());
  return samples;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_OCTREE_SAMPLES_H
