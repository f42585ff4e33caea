// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the points where the tree leaves the ground.

#ifndef PCS_SKELETON_FIND_ROOT_H
#define PCS_SKELETON_FIND_ROOT_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/Layer_tree.h>
#include <pcs/skeleton/Neighbor_graph.h>
#include <pcs/skeleton/Scan.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// How the root is looked for. The trunk is what holds the most points near the lower end.
struct Root_rules
{
  double slab = 0.03; ///< height in which it is looked for, relative to the extent upwards [-]
  double slab_spacings = 8; ///< ... at least this many spacings
  double band = 0.4;   ///< height of the points that are the root, in half widths of the stem [-]
  double rival = 0.03; ///< share of the lowest points of a stem that makes another one a rival [-]
  double smallest_component =
      0.05; ///< share of the points that a part must have to hold the root [-]
  double floating =
      0.05; ///< such parts begin at most this high, relative to the extent upwards [-]
  double lying_length = 6;  ///< a stem of this many heights of the slab lies on its side,
  double lying_ratio = 3;   ///< ... if it is also longer than this many of its widths [-];
  double lying_share = 0.3; ///< so does one with this share of its part's points in the slab,
  double lying_side = 2;    ///< ... if it is longer than this many heights of the slab [-]
};

namespace internal {

/// Mean and spread across `up` of a set of points.
struct Slab_shape
{
  Vec3 mean = Vec3::Zero();
  Vec3 along = Vec3::UnitX();   ///< the direction of the largest spread, to where the points rise
  double length = 0, width = 0; ///< standard deviations along and across it

  Slab_shape(const Scan& scan, const std::vector<Index>& points, const Vec3& up)
  {
    for (const Index i : points)
      mean += scan.points[i];
    mean /= double(points.size());
    const Vec3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const Index i : points) {
      const Vec3 d = scan.points[i] - mean;
      const Eigen::Vector2d q(d.dot(e1), d.dot(e2));
      covariance += q * q.transpose();
    }
    const auto eigen = linear_algebra::symmetric_eigen<2>(covariance / double(points.size()));
    const Eigen::Vector2d v = eigen.vectors.col(1);
    along = v(0) * e1 + v(1) * e2;
    double rise = 0;
    for (const Index i : points)
      rise += (scan.points[i] - mean).dot(along) * (scan.points[i] - mean).dot(up);
    if (rise < 0)
      along = -along;
    width = std::sqrt(std::max(0.0, eigen.values(0)));
    length = std::sqrt(std::max(0.0, eigen.values(1)));
  }
};

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

  std::vector<Index> points_of(Index s) const
  {
    std::vector<Index> points;
    for (Index i = 0; i < part.size(); ++i)
      if (part[i] == s)
        points.push_back(i);
    return points;
  }
};

/// Connected points near the lower end of their part.
struct Stem
{
  std::vector<Index> points;
  Slab_shape shape;
  bool is_lying; ///< on its side

  Stem(const Scan& scan,
       const Vec3& up,
       double slab,
       const Point_parts& parts,
       const Point_parts& low_parts,
       Index s,
       const Root_rules& rules)
    : points(low_parts.points_of(s)), shape(scan, points, up)
  {
    const double length = std::sqrt(12.0) * shape.length; // of a line with this deviation
    const double share = double(points.size()) / double(parts.size[parts.part[s]]);
    is_lying =
        (length > rules.lying_length * slab && shape.length > rules.lying_ratio * shape.width) ||
        (length > rules.lying_side * slab && share > rules.lying_share);
  }
};

/// Of all stems, that from which most of the points high up are nearest along the points; `first` if none has much more.
/// `stem_of_point` tells those of the lowest points. O(points log points).
inline Index busiest_stem(const Scan& scan,
                          const std::vector<double>& height,
                          const std::vector<Link>& links,
                          const std::vector<Index>& stem_of_point,
                          Index first)
{
  constexpr double much = 2; // times as many points as the first
  constexpr double up = 0.5; // of the height of all that is reached
  std::vector<Index> nearest = stem_of_point, sources, way;
  for (Index i = 0; i < nearest.size(); ++i)
    if (nearest[i] != none)
      sources.push_back(i);
  const Shortest_paths paths = shortest_paths(scan, graph_of(scan.size(), links), sources);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (Index i = 0; i < nearest.size(); ++i) {
    way.clear();
    Index at = i;
    for (; nearest[at] == none && paths.predecessor[at] != at; at = paths.predecessor[at])
      way.push_back(at);
    const Index stem = nearest[at];
    if (stem == none)
      continue; // out of reach
    low = std::min(low, height[i]);
    high = std::max(high, height[i]);
    for (const Index j : way)
      nearest[j] = stem;
  }
  std::vector<std::size_t> count(scan.size(), 0);
  for (Index i = 0; i < nearest.size(); ++i)
    if (nearest[i] != none && height[i] > low + up * (high - low))
      ++count[nearest[i]];
  Index best = first;
  for (Index s = 0; s < count.size(); ++s)
    if (double(count[s]) > std::max(double(count[best]), much * double(count[first])))
      best = s;
  return best;
}

} // namespace internal

/*!
  The lowest layer of points of the thickest thing that stands at the lower end of a large connected part, the tall ones
  first. Of a stem that lies on its side, or of a flat cloud, one end. `links` are those between neighbours, without closed
  gaps. Never empty if a point is used.
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
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> height(n), low_of(n, infinity), high_of(n, -infinity);
  double low = infinity, high = -infinity;
  for (Index i = 0; i < n; ++i) {
    height[i] = up.dot(scan.points[i]);
    if (!is_used[i] || parts.size[parts.part[i]] < smallest)
      continue;
    low = std::min(low, height[i]);
    high = std::max(high, height[i]);
    low_of[parts.part[i]] = std::min(low_of[parts.part[i]], height[i]);
    high_of[parts.part[i]] = std::max(high_of[parts.part[i]], height[i]);
  }
  const double slab = std::max(rules.slab * (high - low), rules.slab_spacings * scan.spacing);
  const double floating = low + rules.floating * (high - low);
  std::vector<std::uint8_t> is_low(n, 0);
  for (Index i = 0; i < n; ++i)
    if (is_used[i] && low_of[parts.part[i]] <= floating)
      is_low[i] = height[i] <= low_of[parts.part[i]] + slab;
  const internal::Point_parts low_parts(is_low, links);
  Index first = none;
  double best = -1;
  for (Index s = 0; s < n; ++s)
    if (low_parts.size[s] > 0) {
      const Index part = parts.part[s];
      const double score =
          double(low_parts.size[s]) * (high_of[part] - low_of[part] + scan.spacing);
      if (score > best) {
        best = score;
        first = s;
      }
    }
  internal::Stem stem(scan, up, slab, parts, low_parts, first, rules);
  // shrubs about a tree may have more points near the ground than its trunk
  const auto rivals = std::count_if(low_parts.size.begin(), low_parts.size.end(), [&](Index size) {
    return double(size) > rules.rival * double(stem.points.size());
  });
  if (!stem.is_lying && rivals > 1) { // the stem itself is one
    const Index busiest = internal::busiest_stem(scan, height, links, low_parts.part, first);
    stem = internal::Stem(scan, up, slab, parts, low_parts, busiest, rules);
  }
  // all around a thick stem, or the layers above would be tilted; of a lying one the end
  const double spread =
      stem.is_lying ? stem.shape.width : std::hypot(stem.shape.length, stem.shape.width);
  const double band = std::max(layer_thickness * scan.spacing, rules.band * spread);
  const auto place = [&](Index i) {
    return stem.is_lying ? stem.shape.along.dot(scan.points[i]) : height[i];
  };
  std::vector<Index>& root = stem.points;
  double foot = infinity;
  for (const Index i : root)
    foot = std::min(foot, place(i));
  root.erase(
      std::remove_if(root.begin(), root.end(), [&](Index i) { return place(i) > foot + band; }),
      root.end());
  return std::move(root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FIND_ROOT_H
