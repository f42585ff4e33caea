// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the points where the tree leaves the ground.

#ifndef PCS_SKELETON_FIND_ROOT_H
#define PCS_SKELETON_FIND_ROOT_H

#include <pcs/skeleton/Layer_tree.h>
#include <pcs/skeleton/Neighbor_graph.h>
#include <pcs/skeleton/Scan.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// How the root is looked for. The trunk is what holds the most points near the lower end.
struct Root_rules
{
  double slab = 0.03; ///< height in which it is looked for, relative to the extent upwards [-]
  double slab_spacings = 8; ///< ... at least this many spacings
  double band = 0.4; ///< height of the points that are the root, in half widths of the stem [-]
  double smallest_component =
      0.05; ///< share of the points that a part must have to hold the root [-]
};

namespace internal {

/// The connected parts of the points of `is_used`: the set of each point, and the size of each set.
struct Point_parts
{
  std::vector<Index> part; ///< a point of the part; `none` if not used
  std::vector<Index> size; ///< by that point

  Point_parts(const std::vector<std::uint8_t>& is_used, const std::vector<Link>& links)
    : part(is_used.size(), none), size(is_used.size(), 0)
  {
    Point_sets sets(is_used.size());
    for (const Link& l : links)
      if (is_used[l.first] && is_used[l.second])
        sets.unite(l.first, l.second);
    for (Index i = 0; i < is_used.size(); ++i)
      if (is_used[i])
        ++size[part[i] = sets.find(i)];
  }
};

} // namespace internal

/*!
  The lowest layer of points of the thickest thing that stands at the lower end of a large connected part.
  `links` are those between neighbours, without closed gaps. Never empty if a point is used.
*/
inline std::vector<Index> find_root(const Scan& scan,
                                    const std::vector<std::uint8_t>& is_used,
                                    const std::vector<Link>& links,
                                    const Vec3& up,
                                    const Root_rules& rules)
{
  const Index n = static_cast<Index>(scan.size());
  const internal::Point_parts parts(is_used, links);
  const Index largest = *std::max_element(parts.size.begin(), parts.size.end());
  const double smallest = std::min(double(largest), rules.smallest_component * double(n));
  std::vector<double> height(n);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto is_large = [&](Index i) {
    return is_used[i] && parts.size[parts.part[i]] >= smallest;
  };
  for (Index i = 0; i < n; ++i) {
    height[i] = up.dot(scan.points[i]);
    if (is_large(i)) {
      low = std::min(low, height[i]);
      high = std::max(high, height[i]);
    }
  }
  const double top = low + std::max(rules.slab * (high - low), rules.slab_spacings * scan.spacing);
  std::vector<std::uint8_t> is_low(n, 0);
  for (Index i = 0; i < n; ++i)
    is_low[i] = is_large(i) && height[i] <= top;
  const internal::Point_parts low_parts(is_low, links);
  const Index stem = static_cast<Index>(
      std::max_element(low_parts.size.begin(), low_parts.size.end()) - low_parts.size.begin());
  double foot = std::numeric_limits<double>::infinity(), count = 0;
  Vec3 mean = Vec3::Zero();
  for (Index i = 0; i < n; ++i)
    if (low_parts.part[i] == stem) {
      foot = std::min(foot, height[i]);
      mean += scan.points[i];
      count += 1;
    }
  mean /= count;
  double spread = 0; // across `up`: all around a thick stem, or the layers above would be tilted
  for (Index i = 0; i < n; ++i)
    if (low_parts.part[i] == stem) {
      const Vec3 d = scan.points[i] - mean;
      spread += (d - up.dot(d) * up).squaredNorm();
    }
  const double band =
      std::max(layer_thickness * scan.spacing, rules.band * std::sqrt(spread / count));
  std::vector<Index> root;
  for (Index i = 0; i < n; ++i)
    if (low_parts.part[i] == stem && height[i] <= foot + band)
      root.push_back(i);
  return root;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FIND_ROOT_H
