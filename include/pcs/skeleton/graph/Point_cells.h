// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Cubic cells of points, with neighbour queries shared by the points of a cell.

#ifndef PCS_SKELETON_GRAPH_POINT_CELLS_H
#define PCS_SKELETON_GRAPH_POINT_CELLS_H

#include <pcs/skeleton/model/Scan.h>

#include <boost/container_hash/hash.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pcs {
namespace skeleton {

class Point_cells
{
public:
  /// Groups the points of `is_used` into cubes of side `side` [L]. O(points).
  Point_cells(const std::vector<Vec3>& points,
              const std::vector<std::uint8_t>& is_used,
              double side)
    : m_cell_of_point(points.size(), none)
  {
    std::unordered_map<Key, Index, boost::hash<Key>> number; // in order of the points
    std::vector<Key> keys;
    for (Index i = 0; i < points.size(); ++i) {
      if (!is_used[i])
        continue;
      const Vec3 q = points[i] / side;
      const Key key{std::floor(q.x()) + 0, std::floor(q.y()) + 0, std::floor(q.z()) + 0}; // no -0
      const auto [place, is_new] = number.emplace(key, static_cast<Index>(keys.size()));
      if (is_new)
        keys.push_back(key);
      m_cell_of_point[i] = place->second;
    }
    m_around.resize(keys.size());
    for (Index c = 0; c < keys.size(); ++c)
      for (int k = 0; k < 27; ++k) {
        const Key& key = keys[c];
        const auto place =
            number.find({key[0] + k % 3 - 1, key[1] + k / 3 % 3 - 1, key[2] + k / 9 - 1});
        if (place != number.end())
          m_around[c].push_back(place->second);
      }
  }

  /// Returns the cell of a used point.
  Index cell_of(Index point) const { return m_cell_of_point[point]; }

  /// Returns, for each cell, the common label of all points in it and in the 26 adjacent cells;
  /// `none` if they differ. O(points + cells).
  std::vector<Index> common_label(const std::vector<Index>& label_of_point) const
  {
    constexpr Index nothing_yet = none - 1;
    const auto merged = [](Index a, Index b) { return a == nothing_yet || a == b ? b : none; };
    std::vector<Index> label(m_around.size(), nothing_yet), result(label);
    for (std::size_t i = 0; i < m_cell_of_point.size(); ++i)
      if (m_cell_of_point[i] != none) {
        Index& l = label[m_cell_of_point[i]];
        l = merged(l, label_of_point[i]);
      }
    for (std::size_t c = 0; c < label.size(); ++c)
      for (const Index other : m_around[c])
        result[c] = merged(result[c], label[other]);
    return result;
  }

private:
  using Key = std::array<double, 3>; // integers of any size

  std::vector<Index> m_cell_of_point;
  std::vector<std::vector<Index>> m_around; // adjacent cells of each, including itself
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_GRAPH_POINT_CELLS_H
