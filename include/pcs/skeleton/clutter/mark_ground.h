// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ground classification below a tree.

#ifndef PCS_SKELETON_CLUTTER_MARK_GROUND_H
#define PCS_SKELETON_CLUTTER_MARK_GROUND_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/clutter/Terrain.h>
#include <pcs/skeleton/clutter/covers_area.h>
#include <pcs/skeleton/clutter/is_single_sheet.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/layers/Stem_foot.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/leave_out_strays.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for a terrain to be ground: a filled disc or an area of any outline, much wider than
/// the stem above it.
struct Ground_options
{
  double noise = 4;            ///< thickness of ground, in multiples of the terrain noise [-]
  double crowd = 5;            ///< points per cell of the ground [count]
  double round = 0.55;         ///< least fraction of these cells in a disc that contain points [-]
  bool do_accept_areas = true; ///< otherwise, whether other areas may be ground, `covers_area()`:
  double spread = 0.75; ///< least fraction of the neighbours of cells that contain points [-]
  double flat = 3;      ///< least side of the cells, in thicknesses of the ground [-]
  double width = 3;     ///< least distance of its farthest points from the stem, in stem widths [-]
  double lying = 0.01;  ///< least ratio of other points to ground if there is no stem [-]
  double bin = 0.01;   ///< height of a bin / vertical extent; the height is at least 4 spacings [-]
  int bins = 12;       ///< lowest bins for the search of the stem [count]
  double keep = 2;     ///< radius around the stem without search of plants, in stem widths [-]
  double beside = 1.5; ///< radius within which ground is thinner, in stem widths [-] ...
  double foot = 2;     ///< ... and its thickness there, in multiples of the noise [-]
  double thickest = std::numeric_limits<double>::infinity(); ///< ground, in units of the input [L]
  double filled = 0.4; ///< least fraction of filled cells in a bin of plants [-]
  Terrain_options terrain;
  Sheet_options sheet;
};

namespace internal {

/// Center and horizontal root mean square width of one bin.
struct Bin_extent
{
  Vec3 center = Vec3::Zero();
  double width = 0;
  std::size_t count = 0;
};

/// Low points of a scan in bins of equal height, from below.
struct Low_bins
{
  double low = 0, high = 0, height = 0;    ///< nearly all points lie between `low` and `high`
  std::vector<Index> bin;                  ///< of each point; `none`: too high, or not used
  std::vector<std::vector<Index>> members; ///< points by bin

  Low_bins(const Scan& scan,
           const std::vector<double>& height_of,
           const Ground_options& rules,
           const std::vector<std::uint8_t>& is_used)
    : bin(scan.size(), none), members(static_cast<std::size_t>(rules.bins))
  {
    const Index n = static_cast<Index>(scan.size());
    std::vector<float> heights;
    for (Index i = 0; i < n; ++i)
      if (is_used[i])
        heights.push_back(static_cast<float>(height_of[i]));
    if (heights.empty())
      return;
    const std::size_t tail = heights.size() / 1000;
    low = double(pcs::internal::value_of_rank(heights, tail));
    high = double(pcs::internal::value_of_rank(heights, heights.size() - 1 - tail));
    height = std::max(rules.bin * (high - low), 4 * scan.spacing);
    for (Index i = 0; i < n; ++i) {
      const double b = (height_of[i] - low) / height;
      if (is_used[i] && b < double(rules.bins)) {
        bin[i] = static_cast<Index>(std::max(0.0, b));
        members[bin[i]].push_back(i);
      }
    }
  }
};

/// Returns the points of the stem in each bin. The stem is tracked downwards from the dominant
/// component above the bins, by size times height, through connected components.
inline std::vector<std::vector<Index>> stem_in_bins(const Scan& scan,
                                                    const Compact_links& links,
                                                    const std::vector<double>& height_of,
                                                    const std::vector<std::uint8_t>& is_used,
                                                    const Low_bins& bins)
{
  const Index n = static_cast<Index>(scan.size());
  const std::size_t count = bins.members.size();
  Point_sets above(n), sets(n); // connected components above all bins, and in each of them
  Links across;
  for_each_link(links, [&](const Link& l) {
    if (!is_used[l.first] || !is_used[l.second])
      return;
    const Index a = bins.bin[l.first], b = bins.bin[l.second];
    if (a == b)
      (a == none ? above : sets).unite(l.first, l.second);
    else
      across.push_back(l);
  });
  std::vector<Index> size(n, 0);
  std::vector<double> top(n, bins.low);
  for (Index i = 0; i < n; ++i)
    if (is_used[i]) {
      ++size[bins.bin[i] == none ? above.find(i) : sets.find(i)];
      if (bins.bin[i] == none)
        top[above.find(i)] = std::max(top[above.find(i)], height_of[i]);
    }
  Index tallest = none;
  const auto score = [&](Index i) { return double(size[i]) * (top[i] - bins.low); };
  for (Index i = 0; i < n; ++i)
    if (is_used[i] && bins.bin[i] == none &&
        (tallest == none || score(above.find(i)) > score(tallest)))
      tallest = above.find(i);
  std::vector<std::vector<Index>> stem(count);
  std::vector<std::uint8_t> is_stem(n, 0);
  for (Index i = 0; i < n && tallest != none; ++i)
    is_stem[i] = is_used[i] && bins.bin[i] == none && above.find(i) == tallest;
  for (std::size_t b = count; b-- > 0;) {
    Index part = none;
    const auto offer = [&](Index i) {
      const Index s = sets.find(i);
      if (part == none || size[s] > size[part] || (size[s] == size[part] && s < part))
        part = s;
    };
    for (const Link& l : across) {
      if (bins.bin[l.first] == b && is_stem[l.second] && bins.bin[l.second] > b)
        offer(l.first);
      if (bins.bin[l.second] == b && is_stem[l.first] && bins.bin[l.first] > b)
        offer(l.second);
    }
    if (part == none) // a gap: the largest component
      for (const Index i : bins.members[b])
        offer(i);
    for (const Index i : bins.members[b])
      if (sets.find(i) == part) {
        stem[b].push_back(i);
        is_stem[i] = 1;
      }
  }
  return stem;
}

inline Bin_extent extent_of(const Scan& scan, const std::vector<Index>& points, const Vec3& up)
{
  Bin_extent e;
  e.count = points.size();
  for (const Index i : points)
    e.center += scan.points[i];
  if (e.count > 0)
    e.center /= double(e.count);
  double sum = 0;
  for (const Index i : points) {
    const Vec3 d = scan.points[i] - e.center;
    sum += (d - up.dot(d) * up).squaredNorm();
  }
  e.width = e.count > 0 ? std::sqrt(sum / double(e.count)) : 0;
  return e;
}

/// Finds the position where the stem of a tree leaves the ground; no value if there is no stem in
/// the bins. `stem` contains the points of the stem in each bin.
inline std::optional<Stem_foot>
find_foot(const Scan& scan, const std::vector<std::vector<Index>>& stem, const Vec3& up)
{
  std::vector<Bin_extent> extent;
  std::vector<double> widths;
  for (const auto& points : stem) {
    extent.push_back(extent_of(scan, points, up));
    if (extent.back().count >= 6)
      widths.push_back(extent.back().width);
  }
  if (widths.size() < 4)
    return std::nullopt;
  std::sort(widths.begin(), widths.end());
  Stem_foot foot;
  foot.width = widths[widths.size() / 4];
  for (const Bin_extent& bin : extent)
    if (bin.count >= 6 && bin.width <= 1.5 * foot.width) { // lowest bin of the stem alone
      foot.center = bin.center;
      return foot;
    }
  return std::nullopt;
}

/// Detector of ground points: the points of a terrain and of plants on it.
class Ground_finder
{
public:
  Ground_finder(const Scan& scan,
                const Compact_links& links,
                const Vec3& up,
                const Ground_options& rules,
                const std::vector<std::uint8_t>& is_used)
    : m_scan(scan), m_links(links), m_up(up), m_rules(rules), m_is_used(is_used)
  {
    auto terrain = find_terrain(scan, up, rules.terrain, is_used);
    if (!terrain)
      terrain = find_terrain(scan, up, rules.terrain, leave_out_strays(scan, is_used));
    if (terrain)
      find_on(*terrain);
  }

  const std::vector<Index>& points() const { return m_points; }
  /// Returns the foot of the stem on the ground; no value if there is no ground or no stem.
  const std::optional<Stem_foot>& foot() const { return m_foot; }

private:
  double across(Index i, const Stem_foot& foot) const
  {
    const Vec3 d = m_scan.points[i] - foot.center;
    return (d - m_up.dot(d) * m_up).norm();
  }

  double kept(const Stem_foot& foot) const
  {
    return m_rules.keep * foot.width + 4 * m_scan.spacing;
  }

  std::vector<Index> far_from(const Stem_foot& foot, const std::vector<Index>& points) const
  {
    std::vector<Index> far;
    for (const Index i : points)
      if (across(i, foot) > kept(foot))
        far.push_back(i);
    return far;
  }

  bool is_wide(const Stem_foot& foot, const std::vector<Index>& points) const
  {
    return std::any_of(points.begin(), points.end(), [&](Index i) {
      return across(i, foot) > m_rules.width * foot.width;
    });
  }

  /// Returns the horizontal coordinates of points [L].
  std::vector<std::array<double, 2>> places_of(const std::vector<Index>& points) const
  {
    const Vec3 e1 = m_up.unitOrthogonal(), e2 = m_up.cross(e1);
    std::vector<std::array<double, 2>> places;
    for (const Index i : points)
      places.push_back({e1.dot(m_scan.points[i]), e2.dot(m_scan.points[i])});
    return places;
  }

  Sheet_disc disc(const std::vector<Index>& points, const Vec3& center) const
  {
    const Vec3 e1 = m_up.unitOrthogonal();
    return Sheet_disc(m_scan, points, center, e1, m_up.cross(e1));
  }

  /// Returns whether points fill a disc.
  bool is_round(const std::vector<Index>& points) const
  {
    Vec3 center = Vec3::Zero();
    for (const Index i : points)
      center += m_scan.points[i] / double(points.size());
    const Sheet_disc sheet = disc(points, center);
    return sheet.is_filled(sheet.cell_of(m_rules.crowd), m_rules.round);
  }

  /// Returns whether points cover an area of any outline.
  bool is_area(const std::vector<Index>& points, double thickness) const
  {
    return m_rules.do_accept_areas &&
           covers_area(places_of(points), m_rules.crowd, m_rules.flat * thickness, m_rules.spread);
  }

  bool is_filled(const std::vector<Index>& points, const Stem_foot& foot) const
  {
    const Sheet_disc sheet = disc(points, foot.center);
    return sheet.is_filled(std::max(sheet.radius / m_rules.sheet.cells, 3 * m_scan.spacing),
                           m_rules.filled);
  }

  /// Finds the points of the terrain, and of plants in the bins above it.
  void find_on(Terrain terrain)
  {
    const double noise = terrain.noise(m_scan, m_is_used), thickness = m_rules.noise * noise;
    if (thickness * m_scan.frame.unit > m_rules.thickest) // a surface of plants
      return;
    std::vector<double> height(m_scan.size());
    std::vector<Index> layer;
    std::vector<std::uint8_t> is_standing = m_is_used;
    for (Index i = 0; i < m_scan.size(); ++i) {
      height[i] = terrain.height(m_scan.points[i]) - thickness;
      if (!m_is_used[i] || height[i] > 0)
        continue;
      is_standing[i] = 0;
      layer.push_back(i);
    }
    if (layer.empty())
      return;
    if (!is_round(layer) && !is_area(layer, thickness))
      return;
    const Low_bins bins(m_scan, height, m_rules, is_standing);
    const auto foot =
        find_foot(m_scan, stem_in_bins(m_scan, m_links, height, is_standing, bins), m_up);
    if (!foot) { // such as a lying stem
      const auto standing = std::count(is_standing.begin(), is_standing.end(), 1);
      if (double(standing) >= m_rules.lying * double(layer.size()))
        m_points = layer;
      return;
    }
    if (!is_wide(*foot, layer))
      return;
    m_foot = foot;
    m_points = far_from(*foot, layer);
    add_plants(bins, *foot);
    terrain.bridge(foot->center, kept(*foot));
    for (Index i = 0; i < m_scan.size(); ++i) {
      const double distance = across(i, *foot);
      if (!m_is_used[i] || distance > kept(*foot))
        continue;
      const bool is_beside = distance > m_rules.beside * foot->width;
      if (terrain.height(m_scan.points[i]) <=
          (is_beside ? thickness : m_rules.foot * noise) + m_scan.local_spacing[i])
        m_points.push_back(i);
    }
  }

  /// Adds the points of the lowest bins, which plants fill, and of connected components that extend
  /// from these bins into the same number of bins above.
  void add_plants(const Low_bins& bins, const Stem_foot& foot)
  {
    std::size_t filled = 0;
    while (filled < bins.members.size() && is_filled(far_from(foot, bins.members[filled]), foot))
      ++filled;
    std::vector<std::uint8_t> is_low(m_scan.size(), 0), is_plant(m_scan.size(), 0);
    std::vector<Index> low;
    for (std::size_t b = 0; b < std::min(2 * filled, bins.members.size()); ++b)
      for (const Index i : far_from(foot, bins.members[b])) {
        is_low[i] = 1;
        low.push_back(i);
      }
    const Point_parts parts = connected_parts<CGAL::Sequential_tag>(is_low, m_links);
    for (const Index i : low)
      is_plant[parts.part[i]] |= bins.bin[i] < filled;
    for (const Index i : low)
      if (is_plant[parts.part[i]])
        m_points.push_back(i);
  }

  const Scan& m_scan;
  const Compact_links& m_links;
  Vec3 m_up;
  const Ground_options& m_rules;
  const std::vector<std::uint8_t>& m_is_used;
  std::vector<Index> m_points;
  std::optional<Stem_foot> m_foot;
};

} // namespace internal

/// The ground of a scan.
struct Ground
{
  std::size_t number_of_points = 0;
  std::optional<Stem_foot> foot; ///< of the tree that stands on it
};

/*!
  Removes ground from `is_used`. Ground is a terrain below all other points. It covers an area of
  any outline and is much wider than the stem, or an object lies on it. Plants that cover it are
  removed, too. `links`: links between neighbours. O(n log n).
*/
inline Ground mark_ground(const Scan& scan,
                          const Compact_links& links,
                          const Vec3& up,
                          const Ground_options& rules,
                          std::vector<std::uint8_t>& is_used)
{
  if (std::count(is_used.begin(), is_used.end(), 1) < 200)
    return Ground();
  const internal::Ground_finder ground(scan, links, up, rules, is_used);
  for (const Index i : ground.points())
    is_used[i] = 0;
  return {ground.points().size(), ground.foot()};
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_MARK_GROUND_H
