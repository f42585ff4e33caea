// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Voronoi cell of a point in the plane, clipped by its neighbours.

#ifndef PCS_DEFORMATION_BODY_VORONOI_CELL_H
#define PCS_DEFORMATION_BODY_VORONOI_CELL_H

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace deformation {

using Vec2 = Eigen::Vector2d;

/*!
  The Voronoi cell of the origin. It starts as a square and is cut by the bisectors between the
  origin and its neighbours; cutting by the nearest ones first is faster. The remaining sides of the
  square are *open*: there is no neighbour across them.
*/
class Voronoi_cell
{
public:
  /// Resets the cell to a square with this half side [L].
  void reset(double half_side)
  {
    m_corners = {{{half_side, -half_side}, open},
                 {{half_side, half_side}, open},
                 {{-half_side, half_side}, open},
                 {{-half_side, -half_side}, open}};
    update_radius();
  }

  /// Returns the distance of the farthest corner from the origin [L].
  double radius() const { return m_radius; }
  /// Returns the distance beyond which no point cuts the cell [L].
  double reach() const { return 2 * m_radius; }

  /// Cuts the cell by the bisector between the origin and `p`, which must differ. O(corners).
  void cut(const Vec2& p, std::uint32_t neighbor)
  {
    const double half = 0.5 * p.squaredNorm();
    const std::size_t n = m_corners.size();
    m_side.resize(n);
    bool is_cut = false;
    for (std::size_t k = 0; k < n; ++k) {
      m_side[k] = p.dot(m_corners[k].point) - half;
      is_cut = is_cut || m_side[k] > touching * half; // a bisector through a corner cuts nothing
    }
    if (!is_cut)
      return;
    m_next.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t l = k + 1 < n ? k + 1 : 0;
      if (!(m_side[k] > 0))
        m_next.push_back(m_corners[k]);
      if ((m_side[k] > 0) == (m_side[l] > 0))
        continue;
      const double t = m_side[k] / (m_side[k] - m_side[l]);
      // Where the old outline is cut off, the next side is the bisector; where the outline
      // resumes, the next side is the rest of the old side.
      m_next.push_back({m_corners[k].point + t * (m_corners[l].point - m_corners[k].point),
                        m_side[k] > 0 ? m_corners[k].neighbor : neighbor});
    }
    m_corners.swap(m_next);
    update_radius();
  }

  /*!
    Calls `use(neighbor, p, length)` for every side that is not open. `neighbor` is the neighbour
    across the side, `p = position(neighbor)`, and `length` is the length of the side [L]. At the
    border of a sheet, a side adjacent to an open one ends where it meets the segment to `p`.
  */
  template <class Position, class Use>
  void for_each_side(const Position& position, const Use& use) const
  {
    const std::size_t n = m_corners.size();
    for (std::size_t k = 0; k < n; ++k) {
      const Corner& corner = m_corners[k];
      if (corner.neighbor == open)
        continue;
      const Corner& before = m_corners[k > 0 ? k - 1 : n - 1];
      const Corner& after = m_corners[k + 1 < n ? k + 1 : 0];
      const Vec2 p = position(corner.neighbor);
      const Vec2 along = Vec2(-p.y(), p.x()).normalized();
      const double begin = before.neighbor == open ? 0 : along.dot(corner.point);
      const double end = after.neighbor == open ? 0 : along.dot(after.point);
      if (end > begin)
        use(corner.neighbor, p, end - begin);
    }
  }

private:
  static constexpr std::uint32_t open = ~std::uint32_t(0);
  static constexpr double touching = 1e-9; ///< relative tolerance for rounding [-]
  struct Corner
  {
    Vec2 point;
    std::uint32_t neighbor; ///< across the side that begins here, counterclockwise
  };

  void update_radius()
  {
    double squared = 0;
    for (const Corner& c : m_corners)
      squared = std::max(squared, c.point.squaredNorm());
    m_radius = std::sqrt(squared);
  }

  std::vector<Corner> m_corners, m_next;
  std::vector<double> m_side;
  double m_radius = 0;
};

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_VORONOI_CELL_H
