// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detection of walls, roofs and other flat faces.

#ifndef PCS_SKELETON_CLUTTER_MARK_WALLS_H
#define PCS_SKELETON_CLUTTER_MARK_WALLS_H

#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Moments.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for a flat face: points fill a plane that is wider than any flat strip of a stem within
/// the same tolerance.
struct Wall_options
{
  double cell = 0.083;  ///< cell of the grid / root mean square radius of the scan [-] ...
  double spacings = 10; ///< ... but at least this many spacings
  std::size_t most_points = 200000; ///< most points in the sample for the search of planes [count]
  std::size_t fewest_points = 12;   ///< least number of sampled points in a cell [count]
  double flat = 0.1;   ///< largest deviation of the points of a cell from their plane, in cells
  double step = 0.045; ///< largest distance of a point from the plane of its face, in cells
  double share = 0.5;  ///< least fraction of the points of a cell that lie on its face [-]
  double width = 3.5;  ///< least width of a face in cells; with `step`, cylinders have 3.4 at most
  double even = 2.5;   ///< largest ratio of the deviation of a face to the mean deviation of cells
  double crowd = 5;    ///< points per small cell of a uniform distribution [count] ...
  double full = 0.6;   ///< ... and least fraction of these cells that contain points [-]
  double level = 0.7;  ///< cosine of normal and up above which a face is level, not a wall [-]
  double roof =
      0.15; ///< least height of a roof above the lowest point, relative to the vertical extent [-]
  double noise = 3;    ///< points within this many deviations belong to a face [-]
  double reach = 1;    ///< points within this many cells are beside a face ...
  double beside = 0.5; ///< ... and components with this fraction of such points are removed [-]
  int rounds = 4;      ///< of detection; the remaining points may have smaller faces [count]
  double least = 0.01; ///< least fraction of remaining points; otherwise no face is removed [-]
};

namespace internal {

/// Least-squares plane of points, with their standard deviations.
struct Fitted_plane
{
  Vec3 middle, normal, e1, e2;
  Vec3 deviation; ///< across the plane, along the shorter and the longer axis [L]

  explicit Fitted_plane(const Moments& m) : middle(m.mean())
  {
    const auto eigen = linear_algebra::symmetric_eigen<3>(m.covariance());
    normal = eigen.vectors.col(0);
    e1 = eigen.vectors.col(1);
    e2 = eigen.vectors.col(2);
    deviation = eigen.values.cwiseMax(0).cwiseSqrt();
  }
  double height(const Vec3& p) const { return normal.dot(p - middle); }
};

/// Encodes the cell of a two- or three-dimensional grid as one number; indices may be negative.
inline std::uint64_t cell_key(long x, long y, long z)
{
  constexpr long half = 1L << 20;
  return (std::uint64_t(x + half) << 42) | (std::uint64_t(y + half) << 21) |
         std::uint64_t(z + half);
}

} // namespace internal

/// Plane with the cells in it that points fill.
struct Flat_face
{
  internal::Fitted_plane plane;
  double cell = 0;      ///< side of a cell [L]
  double thickness = 0; ///< of the face to each side [L]
  std::vector<std::uint64_t> places;

  /// Returns whether the distance of a point from one of the cells, along the normal, is at most
  /// `reach` [L].
  bool covers(const Vec3& p, double reach) const
  {
    return std::abs(plane.height(p)) <= reach &&
           std::binary_search(places.begin(), places.end(), key(p, 0, 0));
  }
  std::uint64_t key(const Vec3& p, long dx, long dy) const
  {
    constexpr double most = 1 << 20; // of an index
    const Vec3 d = (p - plane.middle) / cell;
    const double x = d.dot(plane.e1), y = d.dot(plane.e2);
    if (!(std::max(std::abs(x), std::abs(y)) < most - 2))
      return 0;
    return internal::cell_key(dx + std::lround(x), dy + std::lround(y), 0);
  }
};

namespace internal {

/// Detector of flat faces by region growing from cells of a grid whose points lie in a plane.
class Face_finder
{
public:
  Face_finder(const Scan& scan, const Wall_options& rules, const std::vector<std::uint8_t>& is_used)
    : m_scan(scan), m_rules(rules)
  {
    sample(is_used);
    if (m_sample.size() < 4 * rules.fewest_points)
      return;
    fill_cells();
    std::vector<Index> seeds;
    for (Index c = 0; c < m_cells.size(); ++c)
      if (m_cells[c].is_flat)
        seeds.push_back(c);
    std::stable_sort(seeds.begin(), seeds.end(), [&](Index a, Index b) {
      return m_cells[a].plane.deviation(0) < m_cells[b].plane.deviation(0);
    });
    for (const Index seed : seeds)
      if (!m_cells[seed].is_taken)
        grow(seed);
  }

  std::vector<Flat_face>& faces() { return m_faces; }

private:
  struct Cell
  {
    Moments moments;
    Fitted_plane plane;
    std::array<long, 3> place;
    std::vector<Index> points;
    bool is_flat = false, is_taken = false;
  };

  /// Samples the used points, which are in spatial order, at a constant stride, and sets the cell
  /// size.
  void sample(const std::vector<std::uint8_t>& is_used)
  {
    const auto used = static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), 1));
    const std::size_t step = 1 + used / m_rules.most_points;
    Moments all;
    std::size_t k = 0;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (is_used[i] && k++ % step == 0) {
        m_sample.push_back(i);
        all.add(m_scan.points[i]);
      }
    if (m_sample.empty())
      return;
    const double radius = Fitted_plane(all).deviation.norm();
    m_cell = std::max(m_rules.cell * radius,
                      m_rules.spacings * m_scan.spacing * std::sqrt(double(step)));
  }

  void fill_cells()
  {
    constexpr double most = 1 << 20; // of an index
    for (const Index i : m_sample) {
      const Vec3 q = m_scan.points[i] / m_cell;
      if (!(q.cwiseAbs().maxCoeff() < most - 2))
        continue;
      const std::array<long, 3> place{std::lround(q(0)), std::lround(q(1)), std::lround(q(2))};
      const auto found = m_index.emplace(cell_key(place[0], place[1], place[2]),
                                         static_cast<Index>(m_cells.size()));
      if (found.second)
        m_cells.push_back({{}, Fitted_plane(one(m_scan.points[i])), place, {}});
      m_cells[found.first->second].moments.add(m_scan.points[i]);
      m_cells[found.first->second].points.push_back(i);
    }
    for (Cell& cell : m_cells) {
      if (cell.points.size() < m_rules.fewest_points)
        continue;
      cell.plane = Fitted_plane(cell.moments);
      cell.is_flat = cell.plane.deviation(0) <= m_rules.flat * m_cell &&
                     cell.plane.deviation(0) <= 0.5 * cell.plane.deviation(1);
    }
  }

  static Moments one(const Vec3& p)
  {
    Moments m;
    m.add(p);
    return m;
  }

  /// Returns the moments of the points of a cell that lie on a plane.
  Moments near_part(const Cell& cell, const Fitted_plane& plane) const
  {
    Moments near;
    for (const Index i : cell.points)
      if (std::abs(plane.height(m_scan.points[i])) <= m_rules.step * m_cell)
        near.add(m_scan.points[i]);
    return near;
  }

  void grow(Index seed)
  {
    std::vector<Index> patch{seed};
    m_cells[seed].is_taken = true;
    Moments moments = m_cells[seed].moments;
    Fitted_plane plane = m_cells[seed].plane;
    double refit = 2 * moments.count;
    for (std::size_t k = 0; k < patch.size(); ++k) {
      const std::array<long, 3> at = m_cells[patch[k]].place;
      for (long dx = -1; dx <= 1; ++dx)
        for (long dy = -1; dy <= 1; ++dy)
          for (long dz = -1; dz <= 1; ++dz) {
            const auto found = m_index.find(cell_key(at[0] + dx, at[1] + dy, at[2] + dz));
            if (found == m_index.end())
              continue;
            Cell& next = m_cells[found->second];
            if (next.is_taken)
              continue;
            const Moments near = near_part(next, plane);
            if (near.count < m_rules.share * double(next.points.size()))
              continue;
            next.is_taken = true;
            patch.push_back(found->second);
            moments.add(near);
            if (moments.count > refit) {
              plane = Fitted_plane(moments);
              refit = 1.5 * moments.count;
            }
          }
    }
    if (double(patch.size()) >= m_rules.width * m_rules.width)
      add_face(patch, Fitted_plane(moments));
  }

  void add_face(const std::vector<Index>& patch, const Fitted_plane& plane)
  {
    double deviation = 0, flat = 0, count = 0;
    for (const Index c : patch) {
      const double size = double(m_cells[c].points.size());
      count += size;
      if (!m_cells[c].is_flat)
        continue;
      deviation += size * m_cells[c].plane.deviation(0);
      flat += size;
    }
    const double width = std::sqrt(12.0) * plane.deviation(1);
    if (width < m_rules.width * m_cell || plane.deviation(0) > m_rules.even * deviation / flat)
      return;
    const double thickness = std::max(m_rules.step * m_cell, m_rules.noise * plane.deviation(0));
    Flat_face face{plane, m_cell, thickness, {}};
    if (!is_filled(patch, face, count))
      return;
    for (const Index c : patch)
      for (long dx = -1; dx <= 1; ++dx)
        for (long dy = -1; dy <= 1; ++dy)
          face.places.push_back(face.key(m_cells[c].plane.middle, dx, dy));
    sort_unique(face.places);
    m_faces.push_back(std::move(face));
  }

  /// Returns whether enough small cells contain points, within cells that have four neighbours.
  bool is_filled(const std::vector<Index>& patch, const Flat_face& face, double count) const
  {
    const double per_cell = count / double(patch.size());
    const long sides = std::max(2L, std::min(6L, std::lround(std::sqrt(per_cell / m_rules.crowd))));
    std::vector<std::pair<long, long>> cells, small;
    for (const Index c : patch)
      for (const Index i : m_cells[c].points) {
        const Vec3 d = m_scan.points[i] - face.plane.middle;
        const long x = static_cast<long>(std::floor(d.dot(face.plane.e1) / m_cell * double(sides)));
        const long y = static_cast<long>(std::floor(d.dot(face.plane.e2) / m_cell * double(sides)));
        small.emplace_back(x, y);
        cells.push_back(coarse(small.back(), sides));
      }
    sort_unique(cells);
    sort_unique(small);
    const auto is_there = [&](long x, long y) {
      return std::binary_search(cells.begin(), cells.end(), std::make_pair(x, y));
    };
    const auto is_inner = [&](const std::pair<long, long>& p) {
      return is_there(p.first - 1, p.second) && is_there(p.first + 1, p.second) &&
             is_there(p.first, p.second - 1) && is_there(p.first, p.second + 1);
    };
    const auto inner = std::count_if(cells.begin(), cells.end(), is_inner);
    const auto full = std::count_if(small.begin(), small.end(), [&](const auto& p) {
      return is_inner(coarse(p, sides));
    });
    return inner >= 4 && double(full) >= m_rules.full * double(inner * sides * sides);
  }

  static std::pair<long, long> coarse(const std::pair<long, long>& p, long sides)
  {
    const auto down = [&](long a) { return a >= 0 ? a / sides : -((sides - 1 - a) / sides); };
    return {down(p.first), down(p.second)};
  }

  template <class T>
  static void sort_unique(std::vector<T>& values)
  {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
  }

  const Scan& m_scan;
  const Wall_options& m_rules;
  double m_cell = 0;
  std::vector<Index> m_sample;
  std::vector<Cell> m_cells;
  std::unordered_map<std::uint64_t, Index> m_index; ///< of cells
  std::vector<Flat_face> m_faces;
};

} // namespace internal

/*!
  Detects flat faces among the points of `is_used`: wide, filled patches of one plane. Patches of
  curved surfaces, such as stems, are narrow. O(n log n) in the sampled points.
*/
inline std::vector<Flat_face>
flat_faces(const Scan& scan, const Wall_options& rules, const std::vector<std::uint8_t>& is_used)
{
  return std::move(internal::Face_finder(scan, rules, is_used).faces());
}

/// Selects faces that are not ground: walls, and level faces high above the lowest point if there
/// are walls.
inline std::vector<Flat_face> walls_and_roofs(const Scan& scan,
                                              const std::vector<Flat_face>& faces,
                                              const Vec3& up,
                                              const Wall_options& rules,
                                              const std::vector<std::uint8_t>& is_used)
{
  std::vector<Flat_face> walls, level;
  for (const Flat_face& face : faces)
    (std::abs(up.dot(face.plane.normal)) > rules.level ? level : walls).push_back(face);
  if (walls.empty() || level.empty())
    return walls;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double low = infinity, high = -infinity;
  std::vector<double> low_of(level.size(), infinity);
  for (Index i = 0; i < scan.size(); ++i) {
    if (!is_used[i])
      continue;
    const double height = up.dot(scan.points[i]);
    low = std::min(low, height);
    high = std::max(high, height);
    for (std::size_t f = 0; f < level.size(); ++f)
      if (height < low_of[f] && level[f].covers(scan.points[i], level[f].thickness))
        low_of[f] = height;
  }
  for (std::size_t f = 0; f < level.size(); ++f)
    if (low_of[f] > low + rules.roof * (high - low))
      walls.push_back(level[f]);
  return walls;
}

/// Removes the points of faces from `is_used`, and returns their number. O(faces x n).
inline std::size_t mark_faces(const Scan& scan,
                              const std::vector<Flat_face>& faces,
                              std::vector<std::uint8_t>& is_used)
{
  std::size_t count = 0;
  for (const Flat_face& face : faces)
    for (Index i = 0; i < scan.size(); ++i)
      if (is_used[i] && face.covers(scan.points[i], face.thickness)) {
        is_used[i] = 0;
        ++count;
      }
  return count;
}

/// Removes connected components beside faces, such as edges, frames and posts, from `is_used`, and
/// returns the number of their points. `links`: links between neighbours. O(faces x n).
inline std::size_t mark_beside_faces(const Scan& scan,
                                     const std::vector<Flat_face>& faces,
                                     const Compact_links& links,
                                     const Wall_options& rules,
                                     std::vector<std::uint8_t>& is_used)
{
  if (faces.empty())
    return 0;
  const Point_parts parts = connected_parts<CGAL::Sequential_tag>(is_used, links);
  std::vector<Index> beside(scan.size(), 0);
  for (Index i = 0; i < scan.size(); ++i)
    if (is_used[i])
      beside[parts.part[i]] += std::any_of(faces.begin(), faces.end(), [&](const Flat_face& face) {
        return face.covers(scan.points[i], rules.reach * face.cell);
      });
  std::size_t count = 0;
  for (Index i = 0; i < scan.size(); ++i) {
    const Index part = parts.part[i];
    if (part == none || double(beside[part]) < rules.beside * double(parts.size[part]))
      continue;
    is_used[i] = 0;
    ++count;
  }
  return count;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_MARK_WALLS_H
