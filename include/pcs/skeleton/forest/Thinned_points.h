// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Voxel thinning: one point per cube.

#ifndef PCS_SKELETON_FOREST_THINNED_POINTS_H
#define PCS_SKELETON_FOREST_THINNED_POINTS_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/internal/parallel.h>
#include <pcs/neighborhood/spatial_order.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// One point per voxel, the lexicographically least, in the order of the voxels.
struct Thinned_points
{
  std::vector<Vec3> points;
  std::vector<Index> of_input; ///< point of the voxel of each input point
};

namespace internal {

/// A grid of cubes over points.
class Voxel_grid
{
public:
  using Cube = std::array<std::int64_t, 3>;

  Voxel_grid(const std::vector<Vec3>& points, double side) : m_low(points.front())
  {
    Vec3 high = m_low;
    for (const Vec3& p : points) {
      m_low = m_low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    m_cell = std::max(side, 1e-15 * (high - m_low).maxCoeff()); // prevents index overflow
    const Cube last = cube_of(high);
    for (std::size_t k = 0; k < last.size(); ++k)
      while (m_bits[k] < 62 && last[k] >> m_bits[k] > 0)
        ++m_bits[k];
  }

  Cube cube_of(const Vec3& p) const
  {
    const Vec3 q = (p - m_low) / m_cell;
    return {static_cast<std::int64_t>(q.x()),
            static_cast<std::int64_t>(q.y()),
            static_cast<std::int64_t>(q.z())};
  }

  /// Returns whether the cubes can be numbered by `key_of()`.
  bool has_keys() const { return m_bits[0] + m_bits[1] + m_bits[2] <= 64; }
  /// Returns a number with the order of the cubes.
  std::uint64_t key_of(const Vec3& p) const
  {
    const Cube cube = cube_of(p);
    std::uint64_t key = 0;
    for (std::size_t k = 0; k < cube.size(); ++k)
      key = key << m_bits[k] | static_cast<std::uint64_t>(cube[k]);
    return key;
  }

private:
  Vec3 m_low;
  double m_cell = 0;                     ///< side of the cubes [L]
  std::array<int, 3> m_bits = {0, 0, 0}; ///< of the indices of the cubes
};

/// Thins the points, with `key_of(point)` in the order of the voxels.
template <class ConcurrencyTag, class KeyOf>
Thinned_points thin_by_keys(const std::vector<Vec3>& input, const KeyOf& key_of)
{
  struct Entry
  {
    decltype(key_of(input.front())) key;
    Index point;
  };
  const std::size_t n = input.size(), block = 4096, number_of_blocks = (n + block - 1) / block;
  pcs::internal::Huge_vector<Entry> entries(n);
  pcs::internal::for_each_index<ConcurrencyTag>(n, [&](std::size_t i) {
    entries[i] = {key_of(input[i]), static_cast<Index>(i)};
  });
  pcs::internal::sort<ConcurrencyTag>(entries.begin(),
                                      entries.end(),
                                      [](const Entry& a, const Entry& b) {
                                        return a.key != b.key ? a.key < b.key : a.point < b.point;
                                      });
  const auto is_first = [&](std::size_t k) {
    return k == 0 || entries[k].key != entries[k - 1].key;
  };
  std::vector<std::size_t> first(number_of_blocks + 1, 0); // first voxel of each block
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      first[begin / block + 1] += is_first(k);
  });
  for (std::size_t b = 0; b < number_of_blocks; ++b)
    first[b + 1] += first[b];
  Thinned_points result;
  result.points.resize(first.back());
  result.of_input.resize(n);
  pcs::internal::for_each_block<ConcurrencyTag>(n, block, [&](std::size_t begin, std::size_t end) {
    std::size_t next = first[begin / block];
    for (std::size_t k = begin; k < end; ++k) {
      if (is_first(k)) {
        Vec3 least = input[entries[k].point];
        for (std::size_t other = k + 1; other < n && !is_first(other); ++other)
          if (neighborhood::lexicographically_less(input[entries[other].point], least))
            least = input[entries[other].point];
        result.points[next++] = least;
      }
      result.of_input[entries[k].point] = static_cast<Index>(next - 1);
    }
  });
  return result;
}

} // namespace internal

/// Keeps one point per cube of side `side` [L]. `input` is finite and not empty. The points do not
/// depend on the order of the input. O(n log n); 16 bytes per point besides the result, or more if
/// the cubes are so many that their numbers have more than 64 bits.
template <class ConcurrencyTag>
Thinned_points thin_by_voxels(const std::vector<Vec3>& input, double side)
{
  const internal::Voxel_grid grid(input, side);
  if (grid.has_keys())
    return internal::thin_by_keys<ConcurrencyTag>(input,
                                                  [&](const Vec3& p) { return grid.key_of(p); });
  return internal::thin_by_keys<ConcurrencyTag>(input,
                                                [&](const Vec3& p) { return grid.cube_of(p); });
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_FOREST_THINNED_POINTS_H
