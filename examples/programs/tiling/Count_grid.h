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

/*!
  The grid is aligned with the origin of the coordinates. If more than `max_cells` cells have
  points, the cell size is doubled until this is no longer the case. Hence the result does not
  depend on the order of the points. Memory: about 80 bytes per cell that has points.
*/
class Count_grid
{
public:
  /// \pre `cell_size > 0`, `max_cells > 0`
  Count_grid(double cell_size, std::size_t max_cells)
    : m_cell_size(cell_size), m_largest_coordinate(1e15 * cell_size), m_max_cells(max_cells)
  {
  }

  double cell_size() const { return m_cell_size; }

  /// Returns the largest absolute value of a coordinate. Beyond it, doubles have no digits left
  /// for the borders of the cells.
  double largest_coordinate() const { return m_largest_coordinate; }

  /// Returns the lower border of the cells with index `i`. Doubling the cell size does not change
  /// the borders that remain, because multiplying by 2 is exact.
  double border(std::int64_t i) const { return static_cast<double>(i) * m_cell_size; }

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

  /// Returns the index `i` with `border(i) <= value < border(i + 1)`, in spite of rounding.
  std::int64_t index_of(double value) const
  {
    auto i = static_cast<std::int64_t>(std::floor(value / m_cell_size));
    while (border(i) > value)
      --i;
    while (border(i + 1) <= value)
      ++i;
    return i;
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
    const auto half = [](std::int64_t i) { return (i - (i < 0 ? 1 : 0)) / 2; }; // rounds down
    while (m_cells.size() > m_max_cells) {
      Cells coarse;
      for (const auto& [index, points] : m_cells)
        add_to(coarse[{half(index[0]), half(index[1])}], points);
      m_cells = std::move(coarse);
      m_cell_size *= 2;
    }
    m_last = nullptr;
  }

  double m_cell_size;
  double m_largest_coordinate;
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
