// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Dimension of the sampling of a surface: even coverage or sparse rows.

#ifndef PCS_SKELETON_LEAVES_SAMPLING_DIMENSION_H
#define PCS_SKELETON_LEAVES_SAMPLING_DIMENSION_H

#include <pcs/skeleton/model/Scan.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  Estimates the intrinsic dimension of the points of `is_part` from the distances to their
  neighbours [Levina and Bickel 2004]: the number of neighbours within `r` grows with `r` to this
  power. It is 2 for random points of a surface, up to 3 for noisy or evenly spaced points, and 1
  for rows that are far from each other. The result is infinite if no point has two neighbours at
  different distances. O(n). [-]
*/
inline double sampling_dimension(const Scan& scan, const std::vector<std::uint8_t>& is_part)
{
  double logarithms = 0, count = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const auto& neighbors = scan.neighbors[i];
    if (!is_part[i] || neighbors.back() == none)
      continue;
    const auto distance_to = [&](Index j) { return (scan.points[j] - scan.points[i]).norm(); };
    const double farthest = distance_to(neighbors.back());
    for (std::size_t k = 0; k + 1 < neighbors.size(); ++k)
      logarithms += std::log(farthest / distance_to(neighbors[k]));
    count += double(neighbors.size() - 1);
  }
  return logarithms > 0 ? count / logarithms : std::numeric_limits<double>::infinity();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LEAVES_SAMPLING_DIMENSION_H
