// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Digital terrain model: the ground below a tree as heights on a grid.

#ifndef PCS_SKELETON_CLUTTER_TERRAIN_H
#define PCS_SKELETON_CLUTTER_TERRAIN_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for a terrain: a surface of lowest points below all other points.
struct Terrain_options
{
  double cell =
      0.025; ///< of the finest grid, relative to the root mean square radius of the scan [-] ...
  double spacings = 4;     ///< ... but at least this many spacings
  int scales = 4;          ///< number of grids, each twice as coarse as the previous one [count]
  double clip = 0.001;     ///< fraction of the points beyond each side of the grid [-]
  double most_cells = 500; ///< most cells along a side of the grid [count]
  double steepest = 1;     ///< largest slope from cell to cell [-]
  double below = 0.02;     ///< largest fraction of points deeper than half a cell [-]
  double sheet = 2; ///< least ratio of points within half a cell to points up to one cell above [-]
  double upright = 3; ///< least ratio of median deviations, vertical to horizontal, of a stem [-]
};

/// Horizontal rectangle that contains nearly all points.
struct Terrain_bounds
{
  Vec3 e1, e2; ///< directions of its sides
  Eigen::Vector2d origin = Eigen::Vector2d::Zero(), extent = Eigen::Vector2d::Zero();

  Terrain_bounds(const Scan& scan,
                 const Vec3& up,
                 const Terrain_options& rules,
                 const std::vector<std::uint8_t>& is_used)
    : e1(up.unitOrthogonal()), e2(up.cross(e1))
  {
    std::vector<double> q;
    q.reserve(scan.size());
    for (Eigen::Index d = 0; d < 2; ++d) {
      const Vec3& along = d == 0 ? e1 : e2;
      q.clear();
      for (std::size_t i = 0; i < scan.size(); ++i)
        if (is_used[i])
          q.push_back(along.dot(scan.points[i]));
      const auto cut = static_cast<std::ptrdiff_t>(rules.clip * double(q.size()));
      const auto low = q.begin() + cut, high = q.end() - 1 - cut;
      std::nth_element(q.begin(), low, q.end());
      origin(d) = *low;
      std::nth_element(low, high, q.end());
      extent(d) = *high - origin(d);
    }
  }
};

/// Largest connected surface of the lowest points of a scan.
class Terrain
{
public:
  Terrain(const Scan& scan,
          const Vec3& up,
          const Terrain_bounds& bounds,
          double cell,
          const Terrain_options& rules,
          const std::vector<std::uint8_t>& is_used)
    : m_up(up), m_e1(bounds.e1), m_e2(bounds.e2), m_origin(bounds.origin)
  {
    m_cell = std::max(cell, bounds.extent.maxCoeff() / rules.most_cells);
    m_size[0] = static_cast<std::size_t>(bounds.extent.x() / m_cell) + 1;
    m_size[1] = static_cast<std::size_t>(bounds.extent.y() / m_cell) + 1;
    m_cells.resize(m_size[0] * m_size[1]);
    find_lowest(scan, is_used);
    const std::vector<std::size_t> surface = largest_surface(rules.steepest * m_cell);
    for (const std::size_t c : surface)
      m_cells[c].nearest = c;
    fit_plane(surface);
    for (const std::size_t c : surface)
      fit_cell(c);
    spread(surface);
  }

  /// Returns the height of `p` above the surface [L]. Beyond its border, the surface continues with
  /// its mean slope.
  double height(const Vec3& p) const
  {
    const Place at = place(p);
    const std::size_t c = cell_of(at.q);
    const Cell& cell = m_cells[m_cells[c].nearest];
    double level = plane_at(at.q) + cell.level;
    if (m_cells[c].nearest == c)
      level += cell.slope.dot(at.q - cell.middle);
    return at.height - level;
  }

  /// Returns whether few points lie below the surface, which are no stem, and few directly above
  /// it.
  bool carries_all(const Scan& scan,
                   const Terrain_options& rules,
                   const std::vector<std::uint8_t>& is_used) const
  {
    const double half = 0.5 * m_cell;
    const auto most_below =
        rules.below * double(std::count(is_used.begin(), is_used.end(), std::uint8_t(1)));
    std::vector<Index> below;
    std::size_t on = 0, above = 0;
    for (std::size_t i = 0; i < scan.size() && double(below.size()) <= most_below; ++i) {
      if (!is_used[i])
        continue;
      const double h = height(scan.points[i]);
      if (h < -half)
        below.push_back(static_cast<Index>(i));
      else if (h <= 3 * half && is_surface(cell_of(place(scan.points[i]).q)))
        ++(h <= half ? on : above);
    }
    return double(below.size()) <= most_below && on > 0 &&
           double(on) >= rules.sheet * double(above) && !is_stem(scan, below, rules.upright);
  }

  /// Returns the 90th percentile of the distances of the points of the surface from it [L].
  double noise(const Scan& scan, const std::vector<std::uint8_t>& is_used) const
  {
    std::vector<double> distances;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const double d = std::abs(height(scan.points[i]));
      if (is_used[i] && d <= 0.5 * m_cell)
        distances.push_back(d);
    }
    if (distances.empty())
      return 0;
    return pcs::internal::value_of_rank(
        distances,
        static_cast<std::size_t>(0.9 * double(distances.size() - 1)));
  }

  /// Replaces the surface in a disc around `center`, the foot of a stem, by a plane fitted to the
  /// ring around it.
  void bridge(const Vec3& center, double radius)
  {
    const Vec2 middle = place(center).q;
    const double outer = 2 * radius + 2 * m_cell;
    std::vector<std::size_t> ring, disc;
    Vec2 mean = Vec2::Zero();
    double level = 0;
    for (std::size_t c = 0; c < m_cells.size(); ++c) {
      const Vec2 q =
          m_origin + m_cell * Vec2(double(c / m_size[1]) + 0.5, double(c % m_size[1]) + 0.5);
      const double distance = (q - middle).norm();
      if (distance <= radius + m_cell)
        disc.push_back(c);
      else if (distance <= outer && is_surface(c)) {
        ring.push_back(c);
        mean += m_cells[c].low.q;
        level += m_cells[c].low.height - plane_at(m_cells[c].low.q);
      }
    }
    if (ring.size() < 3)
      return;
    mean /= double(ring.size());
    level /= double(ring.size());
    const Vec2 slope = slope_of(ring, mean, 0.1 * m_cell * m_cell, [&](std::size_t c) {
      return m_cells[c].low.height - plane_at(m_cells[c].low.q) - level;
    });
    for (const std::size_t c : disc) {
      m_cells[c].nearest = c;
      m_cells[c].middle = mean;
      m_cells[c].slope = slope;
      m_cells[c].level = level;
    }
  }

private:
  using Vec2 = Eigen::Vector2d;
  static constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();

  /// Horizontal and vertical coordinates of a point.
  struct Place
  {
    Vec2 q = Vec2::Zero();
    double height = std::numeric_limits<double>::infinity();
  };

  struct Cell
  {
    Place low;                     ///< lowest point except for a few that may lie below the ground
    std::size_t nearest = nowhere; ///< nearest cell of the surface
    Vec2 middle = Vec2::Zero();    ///< mean of the lowest points of this cell and its neighbours
    Vec2 slope = Vec2::Zero();     ///< of the surface relative to the mean plane [-]
    double level = 0;              ///< of the surface at `middle` above that plane [L]
  };

  Place place(const Vec3& p) const { return {Vec2(m_e1.dot(p), m_e2.dot(p)), m_up.dot(p)}; }

  /// Returns whether points lie along an upright line, by medians: a stem below a whorl of
  /// branches, unlike stray points below the ground.
  bool is_stem(const Scan& scan, const std::vector<Index>& points, double upright) const
  {
    constexpr std::size_t few = 10;
    if (points.size() < few)
      return false;
    std::vector<double> x, y, z, across, along;
    for (const Index i : points) {
      const Place at = place(scan.points[i]);
      x.push_back(at.q.x());
      y.push_back(at.q.y());
      z.push_back(at.height);
    }
    const Vec2 middle(pcs::internal::upper_median(x), pcs::internal::upper_median(y));
    const double level = pcs::internal::upper_median(z);
    for (const Index i : points) {
      const Place at = place(scan.points[i]);
      across.push_back((at.q - middle).norm());
      along.push_back(std::abs(at.height - level));
    }
    return pcs::internal::upper_median(along) >= upright * pcs::internal::upper_median(across);
  }

  double plane_at(const Vec2& q) const
  {
    return m_plane(0) * q(0) + m_plane(1) * q(1) + m_plane(2);
  }

  bool is_surface(std::size_t c) const { return m_cells[c].nearest == c; }

  /// Returns the cell of a position, or the nearest cell at the border.
  std::size_t cell_of(const Vec2& q) const
  {
    const Vec2 place = (q - m_origin) / m_cell;
    const auto clamped = [](double x, std::size_t size) {
      return static_cast<std::size_t>(std::clamp(std::floor(x), 0.0, double(size - 1)));
    };
    return clamped(place.x(), m_size[0]) * m_size[1] + clamped(place.y(), m_size[1]);
  }

  /// Calls `visit` for the cells adjacent to `c`, including diagonal ones if `is_across`.
  template <class Visitor>
  void for_neighbors(std::size_t c, bool is_across, Visitor visit) const
  {
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(c / m_size[1]),
                         j = static_cast<std::ptrdiff_t>(c % m_size[1]);
    for (std::ptrdiff_t a = i - 1; a <= i + 1; ++a)
      for (std::ptrdiff_t b = j - 1; b <= j + 1; ++b)
        if ((a == i) != (b == j) || (is_across && a != i && b != j))
          if (a >= 0 && b >= 0 && std::size_t(a) < m_size[0] && std::size_t(b) < m_size[1])
            visit(std::size_t(a) * m_size[1] + std::size_t(b));
  }

  void find_lowest(const Scan& scan, const std::vector<std::uint8_t>& is_used)
  {
    struct Lowest
    {
      std::array<Place, 3> places; ///< lowest points, ascending
      std::size_t count = 0;
    };
    std::vector<Lowest> lowest(m_cells.size());
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (!is_used[i])
        continue;
      Place p = place(scan.points[i]);
      const Vec2 from = (p.q - m_origin) / m_cell;
      if (!(from.minCoeff() >= 0) || !(from(0) < double(m_size[0])) ||
          !(from(1) < double(m_size[1])))
        continue;
      Lowest& cell = lowest[cell_of(p.q)];
      ++cell.count;
      for (Place& other : cell.places)
        if (p.height < other.height)
          std::swap(p, other);
    }
    for (std::size_t c = 0; c < m_cells.size(); ++c)
      m_cells[c].low = lowest[c].places[std::min<std::size_t>(2, lowest[c].count / 20)];
  }

  /// Returns the largest set of cells connected by height differences of at most `step` [L].
  std::vector<std::size_t> largest_surface(double step) const
  {
    std::vector<std::uint8_t> is_seen(m_cells.size(), 0);
    std::vector<std::size_t> largest, surface;
    for (std::size_t first = 0; first < m_cells.size(); ++first) {
      surface.clear();
      const auto reach = [&](std::size_t c) {
        is_seen[c] = 1;
        surface.push_back(c);
      };
      if (!is_seen[first] && std::isfinite(m_cells[first].low.height))
        reach(first);
      for (std::size_t k = 0; k < surface.size(); ++k) {
        const std::size_t c = surface[k];
        for_neighbors(c, false, [&](std::size_t next) {
          if (!is_seen[next] && std::abs(m_cells[next].low.height - m_cells[c].low.height) <= step)
            reach(next);
        });
      }
      if (surface.size() > largest.size())
        largest = surface;
    }
    return largest;
  }

  void fit_plane(const std::vector<std::size_t>& surface)
  {
    Vec3 mean = Vec3::Zero();
    for (const std::size_t c : surface)
      mean += Vec3(m_cells[c].low.q(0), m_cells[c].low.q(1), m_cells[c].low.height);
    mean /= double(surface.size());
    const Vec2 slope = slope_of(surface, mean.head<2>(), 0, [&](std::size_t c) {
      return m_cells[c].low.height - mean(2);
    });
    m_plane = Vec3(slope(0), slope(1), mean(2) - slope.dot(mean.head<2>()));
  }

  void fit_cell(std::size_t c)
  {
    std::vector<std::size_t> around{c};
    for_neighbors(c, true, [&](std::size_t next) {
      if (is_surface(next))
        around.push_back(next);
    });
    const auto level = [&](std::size_t k) {
      return m_cells[k].low.height - plane_at(m_cells[k].low.q);
    };
    Cell& cell = m_cells[c];
    cell.level = 0;
    for (const std::size_t k : around) {
      cell.middle += m_cells[k].low.q / double(around.size());
      cell.level += level(k) / double(around.size());
    }
    cell.slope = slope_of(around, cell.middle, 0.1 * m_cell * m_cell, [&](std::size_t k) {
      return level(k) - cell.level;
    });
  }

  /// Returns the least-squares slope of heights about `middle`; `damping` regularizes it [L^2].
  template <class Height>
  Vec2 slope_of(const std::vector<std::size_t>& cells,
                const Vec2& middle,
                double damping,
                const Height& height) const
  {
    Eigen::Matrix2d square = (damping + 1e-9 * m_cell * m_cell) * Eigen::Matrix2d::Identity();
    Vec2 product = Vec2::Zero();
    for (const std::size_t c : cells) {
      const Vec2 d = m_cells[c].low.q - middle;
      square += d * d.transpose();
      product += height(c) * d;
    }
    return square.inverse() * product;
  }

  /// Assigns the nearest cell of the surface, in steps, to each other cell.
  void spread(std::vector<std::size_t> reached)
  {
    for (std::size_t k = 0; k < reached.size(); ++k)
      for_neighbors(reached[k], false, [&, c = reached[k]](std::size_t next) {
        if (m_cells[next].nearest == nowhere) {
          m_cells[next].nearest = m_cells[c].nearest;
          reached.push_back(next);
        }
      });
  }

  Vec3 m_up, m_e1, m_e2;
  Vec2 m_origin = Vec2::Zero();
  double m_cell = 0;
  std::array<std::size_t, 2> m_size{};
  std::vector<Cell> m_cells;
  Vec3 m_plane = Vec3::Zero(); ///< slopes along both axes, and the height at the origin
};

/// Finds the terrain below a tree, if the scan contains any. O(n).
inline std::optional<Terrain> find_terrain(const Scan& scan,
                                           const Vec3& up,
                                           const Terrain_options& rules,
                                           const std::vector<std::uint8_t>& is_used)
{
  Vec3 mean = Vec3::Zero();
  double count = 0;
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (is_used[i]) {
      mean += scan.points[i];
      ++count;
    }
  if (count == 0)
    return std::nullopt;
  mean /= count;
  double sum = 0;
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (is_used[i])
      sum += (scan.points[i] - mean).squaredNorm() - std::pow(up.dot(scan.points[i] - mean), 2);
  double cell =
      std::max(rules.cell * std::sqrt(std::max(0.0, sum) / count), rules.spacings * scan.spacing);
  const Terrain_bounds bounds(scan, up, rules, is_used);
  for (int scale = 0; scale < rules.scales; ++scale, cell *= 2) {
    Terrain terrain(scan, up, bounds, cell, rules, is_used);
    if (terrain.carries_all(scan, rules, is_used))
      return terrain;
  }
  return std::nullopt;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_TERRAIN_H
