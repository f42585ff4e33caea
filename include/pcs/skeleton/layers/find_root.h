// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Search for the root: the points of the foot of the trunk.

#ifndef PCS_SKELETON_LAYERS_FIND_ROOT_H
#define PCS_SKELETON_LAYERS_FIND_ROOT_H

#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Slab_shape.h>
#include <pcs/skeleton/model/circle_fit.h>

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
struct Root_options
{
  double slab = 0.03; ///< height in which it is looked for, relative to the extent upwards [-]
  double slab_spacings = 8; ///< ... at least this many spacings
  double thin = 0.003;      ///< stems of less spread, relative to the extent, may be hanging twigs:
  //! ... it is looked for in the first share then, or in the second, and taken if it is ...
  double wide_slab = 0.1, widest_slab = 0.2;
  double thicker =
      /// ... another stem with this many times the spread, in the second one with a round foot [-]
      3;
  double band = 0.4;   ///< height of the points that are the root, in half widths of the stem [-]
  double rival = 0.03; ///< share of the lowest points of a stem that makes another one a rival [-]
  double smallest_component =
      0.05; ///< share of the points that a part must have to hold the root [-]
  double floating =
      0.05; ///< such parts begin at most this high, relative to the extent upwards [-]
  double ring_deviation = 0.15; ///< a trunk is a ring: deviation of its points, in radii [-],
  double ring_spreads = 2;      ///< ... which is at most this many times its spread [-]
  double lying_length = 6;      ///< a stem of this many heights of the slab lies on its side,
  double lying_ratio = 3;       ///< ... if it is also longer than this many of its widths [-];
  double lying_share = 0.3;     ///< so does one with this share of its part's points in the slab,
  double lying_side = 2;        ///< ... if it is longer than this many heights of the slab [-]
};

namespace internal {

/// Connected points near the lower end of their part.
struct Stem
{
  std::vector<Index> points;
  Slab_shape shape;
  bool is_lying; ///< on its side

  double spread() const { return std::hypot(shape.length, shape.width); }

  /// Of the circle that all its points lie on, seen along `up`; 0 if they do not.
  double ring_radius(const Scan& scan, const Vec3& up, const Root_options& rules) const
  {
    const Vec3 e1 = up.unitOrthogonal(), e2 = up.cross(e1);
    std::vector<Vec2> plane;
    for (const Index i : points)
      plane.emplace_back((scan.points[i] - shape.mean).dot(e1),
                         (scan.points[i] - shape.mean).dot(e2));
    const Circle circle = fit_circle(plane);
    const bool is_ring = circle.deviation < rules.ring_deviation * circle.radius &&
                         circle.radius < rules.ring_spreads * spread();
    return is_ring ? circle.radius : 0;
  }

  Stem(const Scan& scan,
       const Vec3& up,
       double slab,
       const Point_parts& parts,
       const Point_parts& low_parts,
       Index s,
       const Root_options& rules)
    : points(low_parts.points_of(s)), shape(scan, points, up)
  {
    const double length = std::sqrt(12.0) * shape.length; // of a line with this deviation
    const double share = double(points.size()) / double(parts.size[parts.part[s]]);
    is_lying =
        (length > rules.lying_length * slab && shape.length > rules.lying_ratio * shape.width) ||
        (length > rules.lying_side * slab && share > rules.lying_share);
  }
};

/// Of all stems, that from which most of the points high up are nearest along the points; `first`
/// if none has much more. `stem_of_point` tells those of the lowest points. O(points log points).
inline Index stem_with_largest_catchment(const Scan& scan,
                                         const std::vector<double>& height,
                                         const Links& links,
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

/// Looks for the stem at the lower end of the large connected parts.
template <class ConcurrencyTag>
class Stem_search
{
public:
  Stem_search(const Scan& scan,
              const std::vector<std::uint8_t>& is_used,
              const Links& links,
              const Point_parts& parts,
              const Vec3& up,
              const Root_options& rules)
    : m_scan(scan),
      m_links(links),
      m_up(up),
      m_rules(rules),
      m_parts(parts),
      m_height(scan.size()),
      m_low_of(scan.size(), infinity),
      m_high_of(scan.size(), -infinity)
  {
    const Index largest = *std::max_element(m_parts.size.begin(), m_parts.size.end());
    const double smallest =
        std::min(double(largest), rules.smallest_component * double(scan.size()));
    for (Index i = 0; i < scan.size(); ++i) {
      m_height[i] = up.dot(scan.points[i]);
      if (!is_used[i] || m_parts.size[m_parts.part[i]] < smallest)
        continue;
      m_low = std::min(m_low, m_height[i]);
      m_high = std::max(m_high, m_height[i]);
      double &low = m_low_of[m_parts.part[i]], &high = m_high_of[m_parts.part[i]];
      low = std::min(low, m_height[i]);
      high = std::max(high, m_height[i]);
    }
  }

  const std::vector<double>& height() const { return m_height; }

  Stem operator()() const
  {
    Stem stem = within(m_rules.slab);
    if (stem.spread() >= m_rules.thin * (m_high - m_low))
      return stem;
    for (const double share : {m_rules.wide_slab, m_rules.widest_slab}) {
      Stem other = within(share);
      const bool is_another =
          other.spread() > m_rules.thicker * stem.spread() &&
          !std::binary_search(other.points.begin(), other.points.end(), stem.points.front());
      if (is_another && (share == m_rules.wide_slab || has_round_foot(other)))
        return other;
    }
    return stem;
  }

private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  /// `share` is that of the extent upwards.
  double height_of_slab(double share) const
  {
    return std::max(share * (m_high - m_low), m_rules.slab_spacings * m_scan.spacing);
  }

  /// Whether the lowest points of a stem are a ring.
  bool has_round_foot(const Stem& stem) const
  {
    double low = infinity;
    for (const Index i : stem.points)
      low = std::min(low, m_height[i]);
    const double slab = height_of_slab(m_rules.slab);
    Stem foot = stem;
    foot.points.erase(std::remove_if(foot.points.begin(),
                                     foot.points.end(),
                                     [&](Index i) { return m_height[i] > low + slab; }),
                      foot.points.end());
    foot.shape = Slab_shape(m_scan, foot.points, m_up);
    return foot.ring_radius(m_scan, m_up, m_rules) > 0;
  }

  /// `share` is that of the extent upwards.
  Stem within(double share) const
  {
    const Index n = static_cast<Index>(m_scan.size());
    const double slab = height_of_slab(share);
    const double floating = m_low + m_rules.floating * (m_high - m_low);
    std::vector<std::uint8_t> is_low(n, 0);
    for (Index i = 0; i < n; ++i) {
      const Index part = m_parts.part[i];
      is_low[i] =
          part != none && m_low_of[part] <= floating && m_height[i] <= m_low_of[part] + slab;
    }
    const Point_parts low_parts = connected_parts<ConcurrencyTag>(is_low, m_links);
    Index first = none;
    double best = -1;
    for (Index s = 0; s < n; ++s)
      if (low_parts.size[s] > 0) {
        const Index part = m_parts.part[s];
        const double score =
            double(low_parts.size[s]) * (m_high_of[part] - m_low_of[part] + m_scan.spacing);
        if (score > best) {
          best = score;
          first = s;
        }
      }
    Stem stem(m_scan, m_up, slab, m_parts, low_parts, first, m_rules);
    // shrubs about a tree may have more points near the ground than its trunk
    const auto rivals =
        std::count_if(low_parts.size.begin(), low_parts.size.end(), [&](Index size) {
          return double(size) > m_rules.rival * double(stem.points.size());
        });
    if (stem.is_lying || rivals < 2) // the stem itself is one
      return stem;
    const Index busiest =
        stem_with_largest_catchment(m_scan, m_height, m_links, low_parts.part, first);
    Stem other(m_scan, m_up, slab, m_parts, low_parts, busiest, m_rules);
    // the foot of a trunk that is cut off from the crown leads to none of its points, a hanging
    // twig to all
    const double ring = stem.ring_radius(m_scan, m_up, m_rules);
    const bool is_foot = ring > m_rules.thicker * other.ring_radius(m_scan, m_up, m_rules);
    return is_foot ? stem : other;
  }

  const Scan& m_scan;
  const Links& m_links;
  const Vec3& m_up;
  const Root_options& m_rules;
  const Point_parts& m_parts;
  std::vector<double> m_height, m_low_of, m_high_of; ///< of points; of parts
  double m_low = infinity, m_high = -infinity;       ///< of the large parts
};

} // namespace internal

/*!
  The lowest layer of points of the thickest thing that stands at the lower end of a large connected
  part, the tall ones first. Of a stem that lies on its side, or of a flat cloud, one end. `links`
  are those between neighbours, without closed gaps, `parts` what hangs together by them. Never
  empty if a point is used.
*/
template <class ConcurrencyTag>
std::vector<Index> find_root(const Scan& scan,
                             const std::vector<std::uint8_t>& is_used,
                             const Links& links,
                             const Point_parts& parts,
                             const Vec3& up,
                             const Root_options& rules)
{
  const internal::Stem_search<ConcurrencyTag> search(scan, is_used, links, parts, up, rules);
  internal::Stem stem = search();
  // all around a thick stem, or the layers above would be tilted; of a lying one the end
  const double spread = stem.is_lying ? stem.shape.width : stem.spread();
  const double band = std::max(layer_thickness * scan.spacing, rules.band * spread);
  const auto place = [&](Index i) {
    return stem.is_lying ? stem.shape.along.dot(scan.points[i]) : search.height()[i];
  };
  std::vector<Index>& root = stem.points;
  double foot = std::numeric_limits<double>::infinity();
  for (const Index i : root)
    foot = std::min(foot, place(i));
  root.erase(
      std::remove_if(root.begin(), root.end(), [&](Index i) { return place(i) > foot + band; }),
      root.end());
  return std::move(root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_FIND_ROOT_H
