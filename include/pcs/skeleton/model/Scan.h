// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A prepared scan: distinct points in a local frame, neighbours, spacing and outliers.

#ifndef PCS_SKELETON_MODEL_SCAN_H
#define PCS_SKELETON_MODEL_SCAN_H

#include <pcs/internal/Huge_page_allocator.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/model/Scan_frame.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace pcs {
namespace skeleton {

using neighborhood::Vec3;
using Index = std::uint32_t;
/// Index of no point, node or branch.
constexpr Index none = std::numeric_limits<Index>::max();

/// Neighbours kept per point [count].
constexpr std::size_t neighbors_per_point = 12;
/// Rank of the neighbour whose distance is the local spacing; the nearest is too noisy.
constexpr std::size_t spacing_neighbor = 4;

/// Prepared scan. Points are distinct, in spatial order, in the coordinates of `frame`. It is not
/// copied or moved, since the search refers to its points.
struct Scan
{
  Scan() = default;
  Scan(const Scan&) = delete;
  Scan& operator=(const Scan&) = delete;

  Scan_frame frame;
  std::vector<Vec3> points;
  std::vector<Index> point_of_input; ///< index into `points` of each input point
  double cell_side = 0; ///< of the cells in which points were merged; 0: not a dense scan [L]
  std::vector<Vec3> place_of_input;    ///< positions before this merging; empty without it
  std::vector<std::uint8_t> is_sparse; ///< points far less dense than wood; empty without merging
  pcs::internal::Huge_vector<std::array<Index, neighbors_per_point>>
      neighbors;                     ///< nearest first, padded with `none`
  std::vector<double> local_spacing; ///< distance to the 4th neighbour [L]
  std::vector<std::uint8_t> is_outlier;
  double spacing = 0; ///< median distance to the nearest neighbour [L]
  std::unique_ptr<neighborhood::Nearest_neighbors> search; ///< over all `points`

  std::size_t size() const { return points.size(); }
  /// Returns the position of an input point.
  const Vec3& position_of_input(std::size_t i) const
  {
    return place_of_input.empty() ? points[point_of_input[i]] : place_of_input[i];
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_SCAN_H
