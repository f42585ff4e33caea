// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Search for the root: the points of the foot of the trunk.

#ifndef PCS_SKELETON_LAYERS_FIND_ROOT_H
#define PCS_SKELETON_LAYERS_FIND_ROOT_H

#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/graph/shortest_paths.h>
#include <pcs/skeleton/layers/Stem_foot.h>
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
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of the root search. A stem is a connected set of points near the lower end of its
/// connected component. The trunk is the stem with the largest product of its number of points and
/// the height of its component. A stem with more than twice its catchment replaces it, unless the
/// first is a much larger ring.
struct Root_options
{
  double slab = 0.03;       ///< height of the searched slab, relative to the vertical extent [-]
  double slab_spacings = 8; ///< least height of the slab, in spacings [-]
  //! spread below which a stem may be a hanging twig, relative to the vertical extent [-]
  double thin = 0.003;
  //! heights of two further slabs, relative to the vertical extent; they are searched if the first
  //! stem is thin [-]
  double wide_slab = 0.1, widest_slab = 0.2;
  //! a stem of a further slab that does not contain the thin stem replaces it if its spread is this
  //! many times as large and, in the widest slab, its foot is round; also the least ratio of the
  //! ring radii of the first stem and of one with a larger catchment [-]
  double thicker = 3;
  double band = 0.4; ///< height of the root points, in spreads of the stem [-]
  //! largest spread of a stem at a given root, relative to the extent; crowns are wider [-]
  double widest_hinted = 0.1;
  //! radius of the foot on the ground without `slab_spacings`, in widths of the stem [-]
  double foot_widths = 2;
  //! least number of points of a stem whose catchment counts, relative to the first [-]
  double rival = 0.03;
  double smallest_component =
      0.05; ///< least fraction of all points in a component that may contain the root [-]
  //! the same for an upright component, such as a stem below an occluded part [-]
  double smallest_piece = 0.01;
  //! least height of such a component, relative to the root mean square distance of its points from
  //! its vertical axis [-]
  double upright = 4;
  //! least cosine between `up` and the vector from its top to the nearest large component [-]
  double above = 0.7;
  //! largest height of the lower end of a component with the root, relative to the extent [-]
  double floating = 0.05;
  double ring_deviation = 0.15; ///< largest deviation of points from a ring, in radii [-]
  double ring_spreads = 2;      ///< largest radius of a ring, in spreads of its points [-]
  //! A stem is lying if its length exceeds `lying_length` slab heights and `lying_ratio` widths, or
  //! if its length exceeds `lying_side` slab heights and its fraction of the component points
  //! exceeds `lying_share` [-].
  double lying_length = 6;
  double lying_ratio = 3;
  double lying_share = 0.3;
  double lying_side = 2;
};

namespace internal {

/// Connected points near the lower end of their component.
struct Stem
{
  std::vector<Index> points;
  Slab_shape shape;
  bool is_lying; ///< whether the stem lies on its side

  double spread() const { return std::hypot(shape.length, shape.width); }

  /// Returns the radius of the circle on which the points lie when projected along `up` [L]; 0 if
  /// they do not form a ring.
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
    // of a uniformly sampled segment with this standard deviation
    const double length = std::sqrt(12.0) * shape.length;
    const double share = double(points.size()) / double(parts.size[parts.part[s]]);
    is_lying =
        (length > rules.lying_length * slab && shape.length > rules.lying_ratio * shape.width) ||
        (length > rules.lying_side * slab && share > rules.lying_share);
  }
};

/// Returns the stem with the largest catchment. The catchment of a stem comprises the points
/// above half the height for which it is the nearest stem along shortest paths. Returns `first`
/// unless the catchment of another stem has more than twice as many points. `stem_of_point`
/// contains the stems of the lowest points. O(points log points).
inline Index stem_with_largest_catchment(const Scan& scan,
                                         const std::vector<double>& height,
                                         const Compact_links& links,
                                         const std::vector<Index>& stem_of_point,
                                         Index first)
{
  constexpr double much = 2; // ratio to the number of points of the first
  constexpr double up = 0.5; // fraction of the height range of all reachable points
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
      continue; // unreachable
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

/// Searches for the stem at the lower end of the large connected components.
template <class ConcurrencyTag>
class Stem_search
{
public:
  Stem_search(const Scan& scan,
              const std::vector<std::uint8_t>& is_used,
              const Compact_links& links,
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
    for (Index i = 0; i < scan.size(); ++i)
      m_height[i] = up.dot(scan.points[i]);
    const std::vector<std::uint8_t> is_large = large_parts(is_used);
    for (Index i = 0; i < scan.size(); ++i) {
      if (!is_used[i] || !is_large[m_parts.part[i]])
        continue;
      m_low = std::min(m_low, m_height[i]);
      m_high = std::max(m_high, m_height[i]);
      double &low = m_low_of[m_parts.part[i]], &high = m_high_of[m_parts.part[i]];
      low = std::min(low, m_height[i]);
      high = std::max(high, m_height[i]);
    }
  }

  const std::vector<double>& height() const { return m_height; }
  double extent() const { return m_high - m_low; } ///< vertical, of all large components [L]

  /// Returns the stem around point `seed`: the connected points at most the height of a slab above
  /// or below it.
  Stem around(Index seed) const
  {
    const double slab = height_of_slab(m_rules.slab);
    std::vector<std::uint8_t> is_near(m_scan.size(), 0);
    for (Index i = 0; i < m_scan.size(); ++i)
      is_near[i] =
          m_parts.part[i] == m_parts.part[seed] && std::abs(m_height[i] - m_height[seed]) <= slab;
    const Point_parts near_parts = connected_parts<ConcurrencyTag>(is_near, m_links);
    return Stem(m_scan, m_up, slab, m_parts, near_parts, near_parts.part[seed], m_rules);
  }

  /// Returns the stem at a foot: the connected points that are at the foot according to
  /// `is_at_foot(position)`, and at most a slab above it. No value without such points.
  template <class IsAtFoot>
  std::optional<Stem> at_foot(const Stem_foot& foot, const IsAtFoot& is_at_foot) const
  {
    const double slab = height_of_slab(m_rules.slab);
    const double top = m_up.dot(foot.center) + slab;
    std::vector<std::uint8_t> is_near(m_scan.size(), 0);
    for (Index i = 0; i < m_scan.size(); ++i)
      is_near[i] = m_parts.part[i] != none && m_height[i] <= top && is_at_foot(m_scan.points[i]);
    const Index seed = m_scan.search
                           ->nearest_if(foot.center,
                                        std::numeric_limits<double>::max(),
                                        [&](Index i) { return is_near[i] != 0; })
                           .index;
    if (!is_near[seed])
      return std::nullopt;
    const Point_parts near_parts = connected_parts<ConcurrencyTag>(is_near, m_links);
    return Stem(m_scan, m_up, slab, m_parts, near_parts, near_parts.part[seed], m_rules);
  }

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

  /// Marks the components that may contain the root: large ones, and smaller ones that are upright,
  /// such as a stem below an occluded part. The result is indexed like `Point_parts::size`.
  std::vector<std::uint8_t> large_parts(const std::vector<std::uint8_t>& is_used) const
  {
    const std::size_t n = m_scan.size();
    const Index largest = *std::max_element(m_parts.size.begin(), m_parts.size.end());
    const double smallest = std::min(double(largest), m_rules.smallest_component * double(n));
    const double smallest_piece = m_rules.smallest_piece * double(n);
    std::vector<std::uint8_t> result(n, 0);
    std::map<Index, std::vector<Index>> pieces;
    for (Index i = 0; i < n; ++i) {
      if (!is_used[i])
        continue;
      const Index part = m_parts.part[i];
      const double size = double(m_parts.size[part]);
      result[part] = size >= smallest;
      if (size < smallest && size >= smallest_piece)
        pieces[part].push_back(i);
    }
    std::vector<Index> stems;
    for (const auto& [part, points] : pieces)
      if (is_below_tree(points, is_used, result))
        stems.push_back(part);
    for (const Index part : stems)
      result[part] = 1;
    return result;
  }

  /// Returns whether a component is upright and a large one lies above it, across a gap of at most
  /// the height of the component.
  bool is_below_tree(const std::vector<Index>& points,
                     const std::vector<std::uint8_t>& is_used,
                     const std::vector<std::uint8_t>& is_large) const
  {
    const auto is_lower = [&](Index i, Index j) { return m_height[i] < m_height[j]; };
    const Index top = *std::max_element(points.begin(), points.end(), is_lower);
    const double height =
        m_height[top] - m_height[*std::min_element(points.begin(), points.end(), is_lower)];
    const Slab_shape shape(m_scan, points, m_up);
    if (height < m_rules.upright * std::hypot(shape.length, shape.width))
      return false;
    const auto above = m_scan.search->nearest_if(m_scan.points[top], height, [&](Index i) {
      return is_used[i] && is_large[m_parts.part[i]];
    });
    return above.squared_distance < height * height &&
           m_height[above.index] - m_height[top] >=
               m_rules.above * std::sqrt(above.squared_distance);
  }

  /// Returns the height of a slab: `share` of the vertical extent, but at least `slab_spacings`
  /// spacings [L].
  double height_of_slab(double share) const
  {
    return std::max(share * (m_high - m_low), m_rules.slab_spacings * m_scan.spacing);
  }

  /// Returns whether the lowest points of a stem form a ring.
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

  /// Returns the stem in a slab. `share` is the height as a fraction of the vertical extent.
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
    // shrubs around a tree may have more points near the ground than its trunk
    const auto rivals =
        std::count_if(low_parts.size.begin(), low_parts.size.end(), [&](Index size) {
          return double(size) > m_rules.rival * double(stem.points.size());
        });
    if (stem.is_lying || rivals < 2) // one rival is `stem` itself
      return stem;
    const Index busiest =
        stem_with_largest_catchment(m_scan, m_height, m_links, low_parts.part, first);
    Stem other(m_scan, m_up, slab, m_parts, low_parts, busiest, m_rules);
    // a trunk foot that is not connected to the crown has no catchment, whereas a hanging twig may
    // have the whole crown as its catchment
    const double ring = stem.ring_radius(m_scan, m_up, m_rules);
    const bool is_foot = ring > m_rules.thicker * other.ring_radius(m_scan, m_up, m_rules);
    return is_foot ? stem : other;
  }

  const Scan& m_scan;
  const Compact_links& m_links;
  const Vec3& m_up;
  const Root_options& m_rules;
  const Point_parts& m_parts;
  std::vector<double> m_height, m_low_of, m_high_of; ///< of points; bounds by component
  double m_low = infinity, m_high = -infinity;       ///< bounds of all large components
};

} // namespace internal

namespace internal {

/// Returns the lowest points of a stem, or the points of one end of a lying stem.
inline std::vector<Index> lowest_points(const Scan& scan,
                                        const std::vector<double>& height,
                                        Stem stem,
                                        const Root_options& rules)
{
  // the band includes the whole circumference of a thick stem, so that level sets are not tilted;
  // the band of a lying stem is one of its ends
  const double spread = stem.is_lying ? stem.shape.width : stem.spread();
  const double band = std::max(layer_thickness * scan.spacing, rules.band * spread);
  const auto place = [&](Index i) {
    return stem.is_lying ? stem.shape.along.dot(scan.points[i]) : height[i];
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

} // namespace internal

/*!
  Returns the lowest points of the stem at the lower end of a large connected component. Stems with
  many points and stems of tall components take precedence. For a lying stem or a flat cloud,
  returns the points of one end. `links` are the edges between neighbours, without the edges that
  close gaps; `parts` are the connected components of this graph. If any point is used, the result
  is not empty.
*/
template <class ConcurrencyTag>
std::vector<Index> find_root(const Scan& scan,
                             const std::vector<std::uint8_t>& is_used,
                             const Compact_links& links,
                             const Point_parts& parts,
                             const Vec3& up,
                             const Root_options& rules)
{
  const internal::Stem_search<ConcurrencyTag> search(scan, is_used, links, parts, up, rules);
  return internal::lowest_points(scan, search.height(), search(), rules);
}

/*!
  Returns the lowest points of the stem whose foot on the ground is known: the result of
  `find_root()` if it is at the foot, otherwise the lowest of the connected points at the foot.
*/
template <class ConcurrencyTag>
std::vector<Index> find_root_at(const Stem_foot& foot,
                                const Scan& scan,
                                const std::vector<std::uint8_t>& is_used,
                                const Compact_links& links,
                                const Point_parts& parts,
                                const Vec3& up,
                                const Root_options& rules)
{
  const internal::Stem_search<ConcurrencyTag> search(scan, is_used, links, parts, up, rules);
  const double reach = rules.foot_widths * foot.width + rules.slab_spacings * scan.spacing;
  const auto is_at_foot = [&](const Vec3& p) {
    return (p - foot.center).cross(up).norm() <= reach;
  };
  internal::Stem stem = search();
  if (!is_at_foot(stem.shape.mean)) {
    if (std::optional<internal::Stem> other = search.at_foot(foot, is_at_foot))
      stem = std::move(*other);
  }
  return internal::lowest_points(scan, search.height(), std::move(stem), rules);
}

/*!
  Returns the points of the stem at the height of `hint`, which lies on its surface or within it:
  the connected points around the used point nearest to `hint`. In a lying stem and in a crown,
  returns only that point.
*/
template <class ConcurrencyTag>
std::vector<Index> find_root_near(const Vec3& hint,
                                  const Scan& scan,
                                  const std::vector<std::uint8_t>& is_used,
                                  const Compact_links& links,
                                  const Point_parts& parts,
                                  const Vec3& up,
                                  const Root_options& rules)
{
  const Index seed = scan.search
                         ->nearest_if(hint,
                                      std::numeric_limits<double>::max(),
                                      [&](Index i) { return is_used[i] != 0; })
                         .index;
  const internal::Stem_search<ConcurrencyTag> search(scan, is_used, links, parts, up, rules);
  internal::Stem stem = search.around(seed);
  if (stem.is_lying || stem.spread() > rules.widest_hinted * search.extent())
    return {seed};
  const double band = std::max(layer_thickness * scan.spacing, rules.band * stem.spread());
  std::vector<Index>& root = stem.points;
  root.erase(std::remove_if(root.begin(),
                            root.end(),
                            [&](Index i) {
                              return std::abs(search.height()[i] - search.height()[seed]) > band;
                            }),
             root.end());
  return std::move(root);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_FIND_ROOT_H
