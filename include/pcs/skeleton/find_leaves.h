// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tells the points of leaves from those of wood by the axes that were fitted to both.

#ifndef PCS_SKELETON_FIND_LEAVES_H
#define PCS_SKELETON_FIND_LEAVES_H

#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/Axis.h>
#include <pcs/skeleton/Axis_set.h>
#include <pcs/skeleton/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// When an axis is a leaf. Lengths are in breast heights [-].
struct Leaf_rules
{
  double shortest = 0.077; ///< an axis without wood on it that is shorter is a leaf, ...
  double longest = 0.154;  ///< ... or one that is shorter than this,
  double flatness = 0.1;   ///< ... if it is wider than this share of its length [-]
  double share = 0.25; ///< of the length of all axes that must be leaves, or the tree has none, [-]
  double unexplained = 0.12; ///< ... and of the points that no axis explains [-]
  int rounds = 2;            ///< how often wood is looked for among what is left [count]
};

/// The leaves among axes and points.
struct Leaves
{
  std::vector<std::uint8_t> is_axis_leaf;
  double share = 0; ///< of the length of all axes [-]

  /// What no axis explains beside leaves is a part of one.
  bool is_leaf(const Axis_set& set, Index point) const
  {
    return !set.is_covered(point) || is_axis_leaf[set.axis_of_point[point]] != 0;
  }
};

/*!
  Axes that end without wood on them, and are short, or short and wide: of a leaf the fit makes a stub, of its rim and midrib
  some more. `breast_height` is the unit of the rules. O(points).
*/
template <class ConcurrencyTag>
Leaves
find_leaves(const Axis_set& set, const Scan& scan, double breast_height, const Leaf_rules& rules)
{
  const std::size_t m = set.axes.size();
  Leaves leaves;
  leaves.is_axis_leaf.assign(m, 0);
  std::vector<Index> first(m + 1, 0);
  for (const Index a : set.axis_of_point)
    if (a != none)
      ++first[a + 1];
  for (std::size_t a = 0; a < m; ++a)
    first[a + 1] += first[a];
  std::vector<Index> point(first[m]);
  std::vector<Index> next(first.begin(), first.end() - 1);
  for (Index i = 0; i < set.axis_of_point.size(); ++i)
    if (set.axis_of_point[i] != none)
      point[next[set.axis_of_point[i]]++] = i;
  std::vector<double> length(m);
  pcs::internal::for_each_index<ConcurrencyTag>(
      m,
      [&](std::size_t a) {
        length[a] = length_of(set.axes[a].axis);
        if (!(length[a] < rules.longest * breast_height))
          return;
        const Index begin = first[a], end = first[a + 1];
        bool is_leaf = length[a] < rules.shortest * breast_height || end - begin < 3;
        if (!is_leaf) {
          Vec3 mean = Vec3::Zero();
          for (Index k = begin; k < end; ++k)
            mean += scan.points[point[k]];
          mean /= double(end - begin);
          Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
          for (Index k = begin; k < end; ++k) {
            const Vec3 d = scan.points[point[k]] - mean;
            covariance += d * d.transpose();
          }
          const Vec3 spread = linear_algebra::symmetric_eigen<3>(covariance).values;
          is_leaf = spread(1) > rules.flatness * rules.flatness * spread(2);
        }
        leaves.is_axis_leaf[a] = is_leaf;
      },
      64);
  // what carries wood is wood; the axes on it come later
  std::vector<std::uint8_t> carries_wood(m, 0);
  double all = 0, of_leaves = 0;
  for (std::size_t a = m; a-- > 0;) {
    if (a == 0 || carries_wood[a])
      leaves.is_axis_leaf[a] = 0;
    const Index parent = set.axes[a].parent;
    if (!leaves.is_axis_leaf[a] && parent != none)
      carries_wood[parent] = 1;
    all += length[a];
    of_leaves += leaves.is_axis_leaf[a] ? length[a] : 0;
  }
  leaves.share = all > 0 ? of_leaves / all : 0;
  return leaves;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FIND_LEAVES_H
