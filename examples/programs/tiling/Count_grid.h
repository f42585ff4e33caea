// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Counts points in the cells of a horizontal grid, with a bounded number of cells.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_COUNT_GRID_H
#define PCS_EXAMPLES_PROGRAMS_TILING_COUNT_GRID_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace program {

/// Two horizontal coordinates [L].
using Position_2 = std::array<double, 2>;

/// The two integers of a cell: coordinates divided by the cell size, rounded down.
using Cell_index = std::array<std::int64_t, 2>;

/// The points of a cell.
struct Cell_points
{
  std::uint64_t number_of_points = 0;
  double lowest = 0, highest = 0; ///< heights [L]
};

/// A cell that has points.
struct Grid_cell
{
  Cell_index index{};
  Cell_points points;
};

/// Returns the index `i` with `i * size <= value < (i + 1) * size` in spite of rounding.
/// \pre `|value| <= 1e15 * size`
inline std::int64_t grid_index(double value, double size)
{
  const auto border = [size](std::int64_t i) { return static_cast<double>(i) * size; };
  auto i = static_cast<std::int64_t>(std::floor(value / size));
  while (border(i) > value)
    --i;
  while (border(i + 1) <= value)
    ++i;
  return i;
}

/*!
  The grid is aligned with the origin of the coordinates. If more than `max_cells` cells have
  points, the cell size is doubled until this is no longer the case. Hence the result does not
  depend on the order of the points. Memory: about 80 bytes per cell that has points.
*/
class Count_grid
{
public:
  /// A cell consists of `multiple` units along each axis: values with the same `grid_index()` for
  /// `unit` are in the same cell. \pre all are positive
  Count_grid(double unit, std::size_t max_cells, std::int64_t multiple = 1)
    : m_unit(unit), m_multiple(multiple), m_max_cells(max_cells)
  {
  }

  double cell_size() const { return border(1); }

  /// Returns the largest absolute value of a coordinate. Beyond it, doubles have no digits left
  /// for the borders of the cells.
  double largest_coordinate() const { return 1e15 * m_unit; }

  /// Returns the lower border of the cells with index `i`. Doubling the cell size does not change
  /// the borders that remain.
  double border(std::int64_t i) const { return static_cast<double>(i * m_multiple) * m_unit; }

  /// \pre all values are at most `largest_coordinate()`
  void add(const Position_2& p, double height)
  {
    const Cell_index index = {index_of(p[0]), index_of(p[1])};
    if (m_last == nullptr || index != m_last_index) {
      m_last = &m_cells[index];
      m_last_index = index;
    }
    add_to(*m_last, {1, height, height});
    if (m_cells.size() > m_max_cells)
      coarsen();
  }

  /// Returns the cells that have points, in the order of their indices, and empties the grid.
  std::vector<Grid_cell> take()
  {
    std::vector<Grid_cell> result;
    result.reserve(m_cells.size());
    for (const auto& [index, points] : m_cells)
      result.push_back({index, points});
    m_cells = {};
    m_last = nullptr;
    std::sort(result.begin(), result.end(), [](const Grid_cell& a, const Grid_cell& b) {
      return a.index < b.index;
    });
    return result;
  }

private:
  struct Hash
  {
    std::size_t operator()(const Cell_index& index) const
    {
      constexpr std::uint64_t odd = 0x9e3779b97f4a7c15; // 2^64 / golden ratio: spreads the bits
      const std::uint64_t a = static_cast<std::uint64_t>(index[0]) * odd;
      const std::uint64_t b = (static_cast<std::uint64_t>(index[1]) + (a >> 32)) * odd;
      return static_cast<std::size_t>(b ^ (b >> 32));
    }
  };
  using Cells = std::unordered_map<Cell_index, Cell_points, Hash>;

  /// Returns the index `i` with `border(i) <= value < border(i + 1)`.
  std::int64_t index_of(double value) const
  {
    return divide(grid_index(value, m_unit), m_multiple);
  }

  /// Returns the quotient rounded down.
  static std::int64_t divide(std::int64_t i, std::int64_t by)
  {
    return i / by - (i % by < 0 ? 1 : 0);
  }

  static void add_to(Cell_points& cell, const Cell_points& more)
  {
    const bool is_first = cell.number_of_points == 0;
    cell.lowest = is_first ? more.lowest : std::min(cell.lowest, more.lowest);
    cell.highest = is_first ? more.highest : std::max(cell.highest, more.highest);
    cell.number_of_points += more.number_of_points;
  }

  void coarsen()
  {
    while (m_cells.size() > m_max_cells) {
      Cells coarse;
      for (const auto& [index, points] : m_cells)
        add_to(coarse[{divide(index[0], 2), divide(index[1], 2)}], points);
      m_cells = std::move(coarse);
      m_multiple *= 2;
    }
    m_last = nullptr;
  }

  double m_unit;
  std::int64_t m_multiple;
  std::size_t m_max_cells;
  Cells m_cells;
  Cell_points* m_last = nullptr; ///< the cell of the previous point, often the same
  Cell_index m_last_index{};
};

/*!
  Returns a measure of the height of the trees [L]: the smallest height such that 99 % of the points
  are in cells whose lowest and highest points differ by at most this height. Slopes count only
  within a cell, and single points far above or below do not count. 0 without cells.
*/
inline double height_within_cells(const std::vector<Grid_cell>& cells)
{
  std::vector<std::pair<double, std::uint64_t>> heights;
  std::uint64_t total = 0;
  heights.reserve(cells.size());
  for (const Grid_cell& cell : cells) {
    heights.emplace_back(cell.points.highest - cell.points.lowest, cell.points.number_of_points);
    total += cell.points.number_of_points;
  }
  std::sort(heights.begin(), heights.end());
  const std::uint64_t enough = total - total / 100;
  std::uint64_t count = 0;
  for (const auto& [height, number_of_points] : heights) {
    count += number_of_points;
    if (count >= enough)
      return height;
  }
  return 0;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_COUNT_GRID_H
