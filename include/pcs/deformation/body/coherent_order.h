// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Test whether the caller's order of points is spatially coherent.

#ifndef PCS_DEFORMATION_BODY_COHERENT_ORDER_H
#define PCS_DEFORMATION_BODY_COHERENT_ORDER_H

#include <pcs/deformation/model/Elastic_network.h>
#include <pcs/deformation/model/Point_blocks.h>
#include <pcs/internal/parallel.h>

#include <CGAL/tags.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pcs {
namespace deformation {

/// Largest ratio of the lengths of a block in the caller's order and in the spatial order. Rows of
/// a grid have the ratio 2; at ratio 4 and 50 points per sample, costs and savings are equal.
constexpr double largest_coherent_ratio = 4;
/// Fraction of the blocks that may be longer: ends of scan lines, outliers.
constexpr double largest_incoherent_share = 0.1;

/*!
  Whether upsampling can follow the caller's order. Results are then written to consecutive memory,
  which saves a sixth of the time of the upsampling. Grids and scan lines are coherent. Blocks of
  shuffled points would need too many samples.
  \param points in the caller's order
  \param spatial_order indices of the points in an order that keeps neighbours close together
*/
template <class ConcurrencyTag = CGAL::Sequential_tag>
bool is_coherent_order(const std::vector<Vec3>& points,
                       const std::vector<std::uint32_t>& spatial_order)
{
  const std::size_t number_of_blocks = points.size() / lanes;
  const auto squared_extent = [&](std::size_t block, const auto& point_at) {
    Vec3 low = point_at(block * lanes), high = low;
    for (std::size_t l = 1; l < lanes; ++l) {
      low = low.cwiseMin(point_at(block * lanes + l));
      high = high.cwiseMax(point_at(block * lanes + l));
    }
    return (high - low).squaredNorm();
  };
  // The extent of the block of the spatial order that contains the first point of each block.
  std::vector<float> spatial(number_of_blocks, -1);
  pcs::internal::for_each_index<ConcurrencyTag>(number_of_blocks, [&](std::size_t block) {
    const double extent = squared_extent(block, [&](std::size_t place) -> const Vec3& {
      return points[spatial_order[place]];
    });
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::uint32_t i = spatial_order[block * lanes + l];
      if (i % lanes == 0 && i / lanes < number_of_blocks)
        spatial[i / lanes] = static_cast<float>(extent); // of one point each
    }
  });
  constexpr double largest_square = largest_coherent_ratio * largest_coherent_ratio;
  const std::size_t count = pcs::internal::blocked_reduce<ConcurrencyTag>(
      number_of_blocks,
      std::size_t(0),
      [&](std::size_t block) -> std::size_t {
        const double extent =
            squared_extent(block, [&](std::size_t i) -> const Vec3& { return points[i]; });
        return extent > largest_square * static_cast<double>(spatial[block]) ? 1 : 0;
      },
      std::plus<std::size_t>());
  return static_cast<double>(count) <=
         largest_incoherent_share * static_cast<double>(number_of_blocks);
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_BODY_COHERENT_ORDER_H
