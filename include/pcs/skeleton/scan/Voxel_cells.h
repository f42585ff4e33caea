// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The cells of a voxel grid that contain points, and sums over neighbouring cells.

#ifndef PCS_SKELETON_SCAN_VOXEL_CELLS_H
#define PCS_SKELETON_SCAN_VOXEL_CELLS_H

#include <pcs/internal/parallel.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Occupied cells, sorted by key. The key has 20 bits for each coordinate of the cell, with x
/// first. Points that are too far away for these bits have cells of their own.
class Voxel_cells
{
public:
  using Key = std::uint64_t;

  /// Cells of `points`, in units of `side` [L]. No cell has points of both values of `is_wood`,
  /// which may be empty.
  template <class ConcurrencyTag>
  static Voxel_cells of_points(ConcurrencyTag,
                               const std::vector<Vec3>& points,
                               const std::vector<std::uint8_t>& is_wood,
                               double side)
  {
    std::vector<Entry> entries(points.size());
    pcs::internal::for_each_index<ConcurrencyTag>(points.size(), [&](std::size_t i) {
      const Key wood = !is_wood.empty() && is_wood[i] ? second_class : 0;
      entries[i] = {wood | key_of(points[i] / side, i), static_cast<Index>(i)};
    });
    return Voxel_cells(ConcurrencyTag(), entries);
  }

  /// Blocks of `2^shift` cells along each axis; their points are the cells.
  template <class ConcurrencyTag>
  Voxel_cells blocks(ConcurrencyTag, int shift) const
  {
    std::vector<Entry> entries(size());
    for (std::size_t c = 0; c < size(); ++c) {
      const Key k = keys[c];
      const auto part = [&](int bit) { return (k >> bit & coordinate) >> shift << bit; };
      entries[c] = {k & far ? k : (k & second_class) | part(x_bit) | part(y_bit) | part(0),
                    static_cast<Index>(c)};
    }
    return Voxel_cells(ConcurrencyTag(), entries);
  }

  std::size_t size() const { return keys.size(); }

  /// Calls `f(cell, neighbour)` for all pairs of cells that touch, each cell with itself included.
  /// Calls for different cells may be concurrent. O(cells).
  template <class ConcurrencyTag, class F>
  void for_each_pair(ConcurrencyTag, const F& f) const
  {
    pcs::internal::for_each_block<ConcurrencyTag>(
        size(),
        4096,
        [&](std::size_t begin, std::size_t end) {
          for (std::int64_t x = -1; x <= 1; ++x)
            for (std::int64_t y = -1; y <= 1; ++y) {
              // the cells and their neighbours in this row have the same order
              const Key row = static_cast<Key>(x * (1ll << x_bit) + y * (1ll << y_bit));
              const auto first = std::lower_bound(keys.begin(), keys.end(), keys[begin] + row - 1);
              std::size_t k = static_cast<std::size_t>(first - keys.begin());
              for (std::size_t c = begin; c < end; ++c) {
                if (keys[c] & far) {
                  if (x == 0 && y == 0)
                    f(c, c);
                  continue;
                }
                const Key lowest = keys[c] + row - 1;
                while (k < size() && keys[k] < lowest)
                  ++k;
                for (std::size_t j = k; j < size() && keys[j] <= lowest + 2; ++j)
                  f(c, j);
              }
            }
        });
  }

  std::vector<Key> keys;
  std::vector<Index> cell_of_point;
  std::vector<Index> count; ///< points of each cell

private:
  struct Entry
  {
    Key key;
    Index point;
  };

  static constexpr int y_bit = 21, x_bit = 42, bits = 20;
  static constexpr Key far = Key(1) << 63, second_class = Key(1) << 62,
                       coordinate = (Key(1) << bits) - 1;

  /// Returns the key of the cell of point `i`, whose position `place` is in units of cells. Cells
  /// at the border of the grid remain empty, so that no neighbour is in another row.
  static Key key_of(const Vec3& place, std::size_t i)
  {
    constexpr double half = 1 << (bits - 1), border = 2;
    if (!(place.cwiseAbs().maxCoeff() < half - border))
      return far | i;
    const auto whole = [&](double x) { return static_cast<Key>(std::floor(x) + half); };
    return whole(place.x()) << x_bit | whole(place.y()) << y_bit | whole(place.z());
  }

  template <class ConcurrencyTag>
  Voxel_cells(ConcurrencyTag, std::vector<Entry>& entries) : cell_of_point(entries.size())
  {
    pcs::internal::sort<ConcurrencyTag>(entries.begin(),
                                        entries.end(),
                                        [](const Entry& a, const Entry& b) {
                                          return a.key != b.key ? a.key < b.key : a.point < b.point;
                                        });
    for (const Entry& e : entries) {
      if (keys.empty() || keys.back() != e.key) {
        keys.push_back(e.key);
        count.push_back(0);
      }
      ++count.back();
      cell_of_point[e.point] = static_cast<Index>(keys.size() - 1);
    }
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_VOXEL_CELLS_H
