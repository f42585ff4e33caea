// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Whether points in the plane cover an area, whatever its outline.

#ifndef PCS_SKELETON_CLUTTER_COVERS_AREA_H
#define PCS_SKELETON_CLUTTER_COVERS_AREA_H

#include <pcs/internal/median.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/// Points in the plane, sorted into the cells of a square grid.
class Grid_cells
{
public:
  /// The grid of the side `cell` [L] is shifted by `shift` sides. O(n log n).
  Grid_cells(const std::vector<std::array<double, 2>>& places,
             double cell,
             const std::array<double, 2>& shift = {0, 0})
  {
    std::vector<Cell> all;
    all.reserve(places.size());
    for (const auto& p : places)
      all.emplace_back(std::lround(p[0] / cell + shift[0]), std::lround(p[1] / cell + shift[1]));
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0; i < all.size(); ++i)
      if (i == 0 || all[i] != all[i - 1]) {
        m_cells.push_back(all[i]);
        m_counts.push_back(1);
      } else
        ++m_counts.back();
  }

  /// Returns the number of cells that contain points [count].
  std::size_t size() const { return m_cells.size(); }

  /// Returns the median number of points of these cells [count].
  std::size_t median_count() const
  {
    std::vector<std::size_t> counts = m_counts;
    return pcs::internal::lower_median(counts);
  }

  /// Returns the mean fraction of the eight neighbours of these cells that contain points, too [-].
  double neighbor_fraction() const
  {
    std::size_t count = 0;
    for (const auto& [x, y] : m_cells)
      for (long dx = -1; dx <= 1; ++dx)
        for (long dy = -1; dy <= 1; ++dy)
          if (dx != 0 || dy != 0)
            count += std::binary_search(m_cells.begin(), m_cells.end(), Cell(x + dx, y + dy));
    return double(count) / (8 * double(std::max<std::size_t>(1, size())));
  }

private:
  using Cell = std::pair<long, long>;
  std::vector<Cell> m_cells; // ascending
  std::vector<std::size_t> m_counts;
};

/// Returns the largest extent along an axis [L].
inline double largest_extent(const std::vector<std::array<double, 2>>& places)
{
  double extent = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto [low, high] =
        std::minmax_element(places.begin(), places.end(), [&](const auto& a, const auto& b) {
          return a[k] < b[k];
        });
    extent = std::max(extent, (*high)[k] - (*low)[k]);
  }
  return extent;
}

} // namespace internal

/*!
  Returns whether points in the plane cover an area: a disc, a strip, a ring, or several patches,
  but not a line or a few clusters. Their density may vary.

  The plane is divided into the cells of a square grid. Their side is such that the median number of
  points of a cell that contains points is `crowd`, and at least `least_side` [L]; it is found by
  iteration. The points cover an area if the mean fraction

      f = mean over cells with points of (neighbours with points) / 8                      [-]

  is at least `share`: `f` is 1 inside an area, and 2/8 along a line. It is the mean over four
  grids, which are shifted by half a side. `false` for fewer than 90 points or 13 cells. O(n log n).
*/
inline bool covers_area(const std::vector<std::array<double, 2>>& places,
                        double crowd,
                        double least_side,
                        double share)
{
  constexpr std::size_t fewest_points = 90, fewest_cells = 13;
  constexpr int passes = 16;
  constexpr double same = 0.05;   // relative change of the side that ends the iteration [-]
  constexpr double finest = 1e-6; // least side for equal points, in extents of all points [-]
  if (places.size() < fewest_points)
    return false;
  const double extent = internal::largest_extent(places);
  const double least = std::max(least_side, finest * extent);
  if (!(least > 0) || !std::isfinite(least))
    return false;
  double cell = std::max(least, extent * std::sqrt(crowd / double(places.size())));
  for (int pass = 0; pass < passes; ++pass) {
    const auto count = double(internal::Grid_cells(places, cell).median_count());
    const double next = std::max(least, cell * std::sqrt(crowd / count));
    if (std::abs(next - cell) <= same * cell)
      break;
    cell = next;
  }
  double fraction = 0;
  for (const double x : {0.0, 0.5})
    for (const double y : {0.0, 0.5}) {
      const internal::Grid_cells cells(places, cell, {x, y});
      if (cells.size() < fewest_cells)
        return false;
      fraction += cells.neighbor_fraction() / 4;
    }
  return fraction >= share;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_COVERS_AREA_H
