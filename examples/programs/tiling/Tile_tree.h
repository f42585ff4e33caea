// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Splits a plot into tiles with few points, and finds the tiles of a position.

#ifndef PCS_EXAMPLES_PROGRAMS_TILING_TILE_TREE_H
#define PCS_EXAMPLES_PROGRAMS_TILING_TILE_TREE_H

#include "tiling/Count_grid.h"
#include "tiling/Tile.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace program {

/*!
  A k-d tree whose leaves are the tiles. A box of cells with too many points is split at a border of
  cells, across the longer side of the rectangle of its points, so that the larger half has as few
  points as possible; of equal halves, the first. Tiles are numbered from the lower halves to the
  upper ones.
*/
class Tile_tree
{
public:
  /// A single cell with more points than `max_points` remains one tile. \pre there are cells
  Tile_tree(std::vector<Grid_cell> cells,
            const Count_grid& grid,
            std::uint64_t max_points,
            double buffer)
    : m_cells(std::move(cells)), m_grid(grid), m_max_points(max_points), m_buffer(buffer)
  {
    const Extent e = extent_of(0, m_cells.size());
    Box_2 box;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      box.low[axis] = m_grid.border(e.first[axis]);
      box.high[axis] = m_grid.border(e.last[axis] + 1);
    }
    split(0, m_cells.size(), box);
    estimate_points();
    m_cells = {};
  }

  const std::vector<Tile>& tiles() const { return m_tiles; }

  /// Returns an estimate of the number of points in all tiles with their buffers, as if the points
  /// of a cell were in its center.
  double estimated_points() const { return m_estimated_points; }

  /// Calls `use(t)` for all tiles `t` of `[first, end)` whose buffered box contains `p`.
  template <class Use>
  void for_each_tile(const Position_2& p, std::size_t first, std::size_t end, const Use& use) const
  {
    visit(0, p, first, end, use);
  }

private:
  /// Indices of cells, both included.
  struct Extent
  {
    Cell_index first{}, last{};
  };

  /// A node of the tree with the tiles `[first_tile, end_tile)` below it. The lower half is the
  /// next node.
  struct Node
  {
    std::size_t axis = 0;
    double border = 0;
    std::size_t upper = 0; ///< the node of the upper half; 0: this is a leaf
    std::size_t first_tile = 0, end_tile = 0;
  };

  Extent extent_of(std::size_t begin, std::size_t end) const
  {
    Extent e = {m_cells[begin].index, m_cells[begin].index};
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t axis = 0; axis < 2; ++axis) {
        e.first[axis] = std::min(e.first[axis], m_cells[c].index[axis]);
        e.last[axis] = std::max(e.last[axis], m_cells[c].index[axis]);
      }
    return e;
  }

  std::uint64_t count_points(std::size_t begin, std::size_t end) const
  {
    std::uint64_t count = 0;
    for (std::size_t c = begin; c < end; ++c)
      count += m_cells[c].points.number_of_points;
    return count;
  }

  /// Makes the tiles of the cells `[begin, end)`, whose order changes, in a box.
  void split(std::size_t begin, std::size_t end, const Box_2& box)
  {
    const std::size_t node = m_nodes.size();
    m_nodes.emplace_back();
    m_nodes[node].first_tile = m_tiles.size();
    const std::uint64_t count = count_points(begin, end);
    if (count <= m_max_points || end - begin == 1)
      add_tile(box, count);
    else {
      const Extent e = extent_of(begin, end);
      const std::size_t axis = e.last[1] - e.first[1] > e.last[0] - e.first[0] ? 1 : 0;
      const std::size_t middle = find_middle(begin, end, count, axis);
      const double border = m_grid.border(m_cells[middle].index[axis]);
      Box_2 lower = box, upper = box;
      lower.high[axis] = upper.low[axis] = border;
      m_nodes[node].axis = axis;
      m_nodes[node].border = border;
      split(begin, middle, lower);
      m_nodes[node].upper = m_nodes.size();
      split(middle, end, upper);
    }
    m_nodes[node].end_tile = m_tiles.size();
  }

  /// Sorts the cells along the axis. Returns the first cell of the upper half.
  std::size_t find_middle(std::size_t begin, std::size_t end, std::uint64_t count, std::size_t axis)
  {
    const auto at = [this](std::size_t c) {
      return m_cells.begin() + static_cast<std::ptrdiff_t>(c);
    };
    std::sort(at(begin), at(end), [axis](const Grid_cell& a, const Grid_cell& b) {
      return a.index[axis] < b.index[axis];
    });
    std::size_t middle = begin;
    std::uint64_t lower = 0, fewest = std::numeric_limits<std::uint64_t>::max();
    for (std::size_t c = begin + 1; c < end; ++c) {
      lower += m_cells[c - 1].points.number_of_points;
      const std::uint64_t larger = std::max(lower, count - lower);
      if (m_cells[c].index[axis] != m_cells[c - 1].index[axis] && larger < fewest) {
        fewest = larger;
        middle = c;
      }
    }
    return middle;
  }

  void estimate_points()
  {
    for (const Grid_cell& cell : m_cells) {
      Position_2 center{};
      for (std::size_t axis = 0; axis < 2; ++axis)
        center[axis] = m_grid.border(cell.index[axis]) + m_grid.cell_size() / 2;
      for_each_tile(center, 0, m_tiles.size(), [&](std::size_t) {
        m_estimated_points += static_cast<double>(cell.points.number_of_points);
      });
    }
  }

  void add_tile(const Box_2& box, std::uint64_t count)
  {
    Tile tile{box, box, count};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      tile.buffered.low[axis] = box.low[axis] - m_buffer;
      tile.buffered.high[axis] = box.high[axis] + m_buffer;
    }
    m_tiles.push_back(tile);
  }

  template <class Use>
  void visit(std::size_t n, const Position_2& p, std::size_t first, std::size_t end, const Use& use)
      const
  {
    const Node& node = m_nodes[n];
    if (node.end_tile <= first || node.first_tile >= end)
      return;
    if (node.upper == 0) {
      if (is_in_buffered(m_tiles[node.first_tile], p))
        use(node.first_tile);
      return;
    }
    if (p[node.axis] <= node.border + m_buffer)
      visit(n + 1, p, first, end, use);
    if (p[node.axis] >= node.border - m_buffer)
      visit(node.upper, p, first, end, use);
  }

  std::vector<Grid_cell> m_cells; ///< while the tree is made
  const Count_grid& m_grid;
  std::uint64_t m_max_points;
  double m_buffer;
  double m_estimated_points = 0;
  std::vector<Node> m_nodes;
  std::vector<Tile> m_tiles;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_TILING_TILE_TREE_H
