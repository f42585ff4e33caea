// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Orders points along an octree of tight boxes, so that neighbours in space are neighbours in
// memory.

#ifndef PCS_NEIGHBORHOOD_SPATIAL_ORDER_H
#define PCS_NEIGHBORHOOD_SPATIAL_ORDER_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/parallel.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace pcs {
namespace neighborhood {

using Vec3 = Eigen::Vector3d;

/// A strict order by coordinates, x first; points that compare equal are exact duplicates.
inline bool lexicographically_less(const Vec3& a, const Vec3& b)
{
  return std::make_tuple(a.x(), a.y(), a.z()) < std::make_tuple(b.x(), b.y(), b.z());
}

/// The position at which a cell is divided, as a fraction of its box. It differs from 0.5, because
/// points of regular grids lie exactly in the middle planes. In a translated copy of the cloud,
/// rounding would decide their side. [-]
constexpr double octree_cut = 0.49371;

/// A cell of the octree: the octants around a point near the centre of the *tight* bounding box of
/// its points. Tight boxes keep the depth small even with distant outliers.
struct Octree_cell
{
  Vec3 center = Vec3::Zero();
  double extent = 0; ///< largest side of the tight box [L]

  template <class PointAt>
  Octree_cell(std::size_t begin, std::size_t end, const PointAt& point_at)
  {
    Vec3 low = point_at(begin), high = low;
    for (std::size_t i = begin + 1; i < end; ++i) {
      low = low.cwiseMin(point_at(i));
      high = high.cwiseMax(point_at(i));
    }
    *this = Octree_cell(low, high);
  }

  /// \param low,high the corners of the tight box
  Octree_cell(const Vec3& low, const Vec3& high)
    : center(low + octree_cut * (high - low)), extent((high - low).maxCoeff())
  {
  }

  int octant(const Vec3& p) const
  {
    return (p.x() > center.x() ? 4 : 0) + (p.y() > center.y() ? 2 : 0) +
           (p.z() > center.z() ? 1 : 0);
  }
};

/// The largest number of points of an undivided cell, which `spatial_order()` sorts by coordinates.
/// [count]
constexpr std::size_t octree_leaf_size = 16;

struct Order_entry
{
  Vec3 point;
  std::uint32_t index;
};

namespace internal {

template <class ConcurrencyTag>
void order_cell(pcs::internal::Huge_vector<Order_entry>& entries,
                pcs::internal::Huge_vector<Order_entry>& buffer,
                std::size_t begin,
                std::size_t end)
{
  const auto sort_leaf = [&] {
    std::sort(entries.begin() + static_cast<std::ptrdiff_t>(begin),
              entries.begin() + static_cast<std::ptrdiff_t>(end),
              [](const Order_entry& a, const Order_entry& b) {
                if (a.point == b.point)
                  return a.index < b.index;
                return lexicographically_less(a.point, b.point);
              });
  };
  if (end - begin <= octree_leaf_size) {
    sort_leaf();
    return;
  }
  const Octree_cell cell(begin, end, [&](std::size_t i) -> const Vec3& {
    return entries[i].point;
  });
  if (!(cell.extent > 0)) { // all points are duplicates
    sort_leaf();
    return;
  }
  std::array<std::size_t, 9> first{};
  for (std::size_t i = begin; i < end; ++i)
    ++first[static_cast<std::size_t>(cell.octant(entries[i].point)) + 1];
  first[0] = begin;
  for (std::size_t c = 1; c < 9; ++c)
    first[c] += first[c - 1];
  std::array<std::size_t, 9> next = first;
  for (std::size_t i = begin; i < end; ++i)
    buffer[next[static_cast<std::size_t>(cell.octant(entries[i].point))]++] = entries[i];
  std::copy(buffer.begin() + static_cast<std::ptrdiff_t>(begin),
            buffer.begin() + static_cast<std::ptrdiff_t>(end),
            entries.begin() + static_cast<std::ptrdiff_t>(begin));
  // Two points next to the last representable centre may fall into one octant at every level.
  for (std::size_t c = 0; c < 8; ++c)
    if (first[c + 1] - first[c] == end - begin) {
      sort_leaf();
      return;
    }
  pcs::internal::for_each_index<ConcurrencyTag>(
      8,
      [&](std::size_t c) {
        if (first[c] != first[c + 1])
          order_cell<ConcurrencyTag>(entries, buffer, first[c], first[c + 1]);
      },
      end - begin > 20000 ? 1 : 8);
}

} // namespace internal

/*!
  Returns the points `point_at(i)` of `[0, n)` with their indices, in octree order. Exact duplicates
  are consecutive, the smaller index first. Except for duplicates, the sequence of positions is
  independent of the order of the input. O(n log n).
*/
template <class ConcurrencyTag, class PointAt>
pcs::internal::Huge_vector<Order_entry> ordered_entries(std::size_t n, const PointAt& point_at)
{
  pcs::internal::Huge_vector<Order_entry> entries(n), buffer(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    entries[i] = {point_at(i), static_cast<std::uint32_t>(i)};
  });
  internal::order_cell<ConcurrencyTag>(entries, buffer, 0, n);
  return entries;
}

/// Returns the indices of `points` in octree order.
template <class ConcurrencyTag>
std::vector<std::uint32_t> spatial_order(const std::vector<Vec3>& points)
{
  const auto entries =
      ordered_entries<ConcurrencyTag>(points.size(),
                                      [&](std::size_t i) -> const Vec3& { return points[i]; });
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    order[i] = entries[i].index;
  return order;
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_SPATIAL_ORDER_H
