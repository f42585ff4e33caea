// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Ground classification below a tree.

#ifndef PCS_SKELETON_CLUTTER_MARK_GROUND_H
#define PCS_SKELETON_CLUTTER_MARK_GROUND_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/clutter/Ground.h>
#include <pcs/skeleton/clutter/Terrain.h>
#include <pcs/skeleton/clutter/covers_area.h>
#include <pcs/skeleton/clutter/find_objects.h>
#include <pcs/skeleton/clutter/is_single_sheet.h>
#include <pcs/skeleton/clutter/stem_in_bins.h>
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
  double keep = 2;      ///< radius around the stem without search of plants, in stem widths [-]
  double beside = 1.5;  ///< radius within which ground is thinner, in stem widths [-] ...
  double foot = 2;      ///< ... and its thickness there, in multiples of the noise [-]
  double thickest = std::numeric_limits<double>::infinity(); ///< ground, in units of the input [L]
  double uneven = 0.02; ///< thickness of ground without points / vertical extent [-]
  double filled = 0.4;  ///< least fraction of filled cells in a bin of plants [-]
  Terrain_options terrain;
  Sheet_options sheet;
  Object_options objects;
  Stem_bin_options stem;
};

namespace internal {

/// Center and horizontal root mean square width of one bin.
struct Bin_extent
{
  Vec3 center = Vec3::Zero();
  double width = 0;
  std::size_t count = 0;
};

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
                const std::optional<Vec3>& root,
                const std::vector<std::uint8_t>& is_used)
    : m_scan(scan), m_links(links), m_up(up), m_rules(rules), m_root(root), m_is_used(is_used)
  {
    auto terrain = find_terrain(scan, up, rules.terrain, is_used);
    if (!terrain)
      terrain = find_terrain(scan, up, rules.terrain, leave_out_strays(scan, is_used));
    if (terrain)
      find_on(*terrain);
    if (m_points.empty() && m_rules.objects.do_remove)
      find_objects_without_ground();
  }

  const std::vector<Index>& points() const { return m_points; }
  /// Returns the points of separate objects that stand on the ground.
  const std::vector<Index>& objects() const { return m_objects; }
  Ground ground() &&
  {
    m_ground.number_of_points = m_points.size();
    m_ground.number_of_object_points = m_objects.size();
    return std::move(m_ground);
  }

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
    const Low_bins bins(m_scan, height, m_rules.stem, is_standing);
    const auto foot =
        find_foot(m_scan,
                  stem_in_bins(m_scan, m_links, height, is_standing, bins, m_rules.stem).bins,
                  m_up);
    if (!foot) { // such as a lying stem
      const auto standing = std::count(is_standing.begin(), is_standing.end(), 1);
      if (double(standing) >= m_rules.lying * double(layer.size()))
        m_points = layer;
      return;
    }
    if (!is_wide(*foot, layer))
      return;
    m_ground.foot = foot;
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
    if (m_rules.objects.do_remove)
      find_objects_beside(*foot, height);
    m_ground.terrain = std::move(terrain);
    m_ground.thickness = thickness;
    m_ground.up = m_up;
  }

  /// Finds objects at the level of the foot if the stem is linked down to the lowest points. The
  /// ground, which was removed before, or not scanned, need not be quite level.
  void find_objects_without_ground()
  {
    std::vector<double> height(m_scan.size());
    for (Index i = 0; i < m_scan.size(); ++i)
      height[i] = m_up.dot(m_scan.points[i]);
    const Low_bins bins(m_scan, height, m_rules.stem, m_is_used);
    const Stem_in_bins stem = stem_in_bins(m_scan, m_links, height, m_is_used, bins, m_rules.stem);
    const auto foot = stem.is_linked ? find_foot(m_scan, stem.bins, m_up) : std::nullopt;
    if (!foot)
      return;
    m_ground.foot = foot;
    m_ground.level = bins.low;
    m_ground.thickness = m_rules.uneven * (bins.high - bins.low);
    m_ground.up = m_up;
    for (double& h : height)
      h -= bins.low + m_ground.thickness;
    find_objects_beside(*foot, height);
  }

  /// Finds objects among the points above the ground. `height`: of each point [L].
  void find_objects_beside(const Stem_foot& foot, const std::vector<double>& height)
  {
    std::vector<std::uint8_t> is_left = m_is_used, is_stem(m_scan.size(), 0);
    for (const Index i : m_points)
      is_left[i] = 0;
    for (Index i = 0; i < m_scan.size(); ++i)
      is_stem[i] = is_left[i] && across(i, foot) <= kept(foot);
    if (m_root) {
      const auto is_wanted = [&](Index i) { return is_left[i] != 0; };
      const auto nearest =
          m_scan.search->nearest_if(*m_root, std::numeric_limits<double>::infinity(), is_wanted);
      if (std::isfinite(nearest.squared_distance))
        is_stem[nearest.index] = 1;
    }
    m_objects = find_objects(m_scan, m_links, height, is_left, is_stem, m_rules.objects);
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
  const std::optional<Vec3>& m_root;
  const std::vector<std::uint8_t>& m_is_used;
  std::vector<Index> m_points, m_objects;
  Ground m_ground;
};

} // namespace internal

/*!
  Removes ground from `is_used`. Ground is a terrain below all other points. It covers an area of
  any outline and is much wider than the stem, or an object lies on it. Plants that cover it, and
  separate objects that stand on it, are removed, too; not the component of the point nearest to a
  given root. `links`: links between neighbours. O(n log n).
*/
inline Ground mark_ground(const Scan& scan,
                          const Compact_links& links,
                          const Vec3& up,
                          const Ground_options& rules,
                          const std::optional<Vec3>& root,
                          std::vector<std::uint8_t>& is_used)
{
  if (std::count(is_used.begin(), is_used.end(), 1) < 200)
    return Ground();
  internal::Ground_finder finder(scan, links, up, rules, root, is_used);
  for (const auto* points : {&finder.points(), &finder.objects()})
    for (const Index i : *points)
      is_used[i] = 0;
  return std::move(finder).ground();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_MARK_GROUND_H
