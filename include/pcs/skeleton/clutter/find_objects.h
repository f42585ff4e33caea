// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Separate objects that stand on the ground beside a tree.

#ifndef PCS_SKELETON_CLUTTER_FIND_OBJECTS_H
#define PCS_SKELETON_CLUTTER_FIND_OBJECTS_H

#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Scan.h>

#include <CGAL/tags.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for an object beside a tree.
struct Object_options
{
  bool do_remove = true;   ///< whether objects are removed
  std::size_t fewest = 30; ///< least number of its points; fewer do no harm [count]
  double standing = 3;     ///< largest height of its lowest point, in spacings [-]
  double low = 0.5;        ///< largest height of an object / height of all points [-]
  double gap = 0.1;        ///< least distance from the tree / height of the object [-] ...
  double spacings = 10;    ///< ... but at least this many spacings [-]
};

/*!
  Returns the points of separate objects that stand on the ground, such as posts, fences, rocks,
  vehicles and shrubs: a tree touches the ground at its foot only. An object is a connected
  component of at least `fewest` used points with

  - a point at most `standing` spacings above the ground,
  - no point of `is_stem`,
  - a height of at most `low` times the height of all used points, and
  - a distance from all other components that is larger than `gap` times its height, and than
    `spacings` spacings. Branches that hang down to the ground are nearer to the tree.

  `height`: of each point above the ground [L]; `links`: between neighbours. O(n log n), and O(n) if
  no component stands on the ground beside the stem.
*/
inline std::vector<Index> find_objects(const Scan& scan,
                                       const Compact_links& links,
                                       const std::vector<double>& height,
                                       const std::vector<std::uint8_t>& is_used,
                                       const std::vector<std::uint8_t>& is_stem,
                                       const Object_options& rules)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Index n = static_cast<Index>(scan.size());
  const Point_parts parts = connected_parts<CGAL::Sequential_tag>(is_used, links);
  std::vector<double> low(n, infinity), high(n, -infinity); // by component [L]
  std::vector<std::uint8_t> is_kept(n, 0);                  // by component
  double top = 0;
  for (Index i = 0; i < n; ++i)
    if (is_used[i]) {
      const Index part = parts.part[i];
      low[part] = std::min(low[part], height[i] - rules.standing * scan.local_spacing[i]);
      high[part] = std::max(high[part], height[i]);
      is_kept[part] |= is_stem[i];
      top = std::max(top, height[i]);
    }
  std::vector<Vec3> tree;       // points of all other components
  std::vector<Index> candidate; // points of components that may be objects
  for (Index i = 0; i < n; ++i)
    if (is_used[i]) {
      const Index part = parts.part[i];
      is_kept[part] |=
          parts.size[part] < rules.fewest || low[part] > 0 || high[part] > rules.low * top;
      if (is_kept[part])
        tree.push_back(scan.points[i]);
      else
        candidate.push_back(i);
    }
  if (candidate.empty() || tree.empty())
    return {};
  const neighborhood::Nearest_neighbors search(tree);
  for (const Index i : candidate) {
    const Index part = parts.part[i];
    if (is_kept[part])
      continue;
    const double gap = std::max(rules.gap * high[part], rules.spacings * scan.spacing);
    is_kept[part] =
        search.nearest_if(scan.points[i], gap, [](Index) { return true; }).squared_distance <
        infinity;
  }
  candidate.erase(std::remove_if(candidate.begin(),
                                 candidate.end(),
                                 [&](Index i) { return is_kept[parts.part[i]] != 0; }),
                  candidate.end());
  return candidate;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_FIND_OBJECTS_H
