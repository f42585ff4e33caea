// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Median length of the links of a point.

#ifndef PCS_NEIGHBORHOOD_MEDIAN_LINK_H
#define PCS_NEIGHBORHOOD_MEDIAN_LINK_H

#include <pcs/internal/lanes.h>
#include <pcs/neighborhood/Proximity_graph.h>
#include <pcs/neighborhood/spatial_order.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace neighborhood {

namespace internal {

/// Sorts eight values by a network of exchanges, which has no branches.
inline void sort_eight(double* v)
{
  constexpr std::size_t first[] = {0, 1, 4, 5, 0, 1, 2, 3, 0, 2, 4, 6, 2, 3, 1, 3, 1, 3, 5};
  constexpr std::size_t second[] = {2, 3, 6, 7, 4, 5, 6, 7, 1, 3, 5, 7, 4, 5, 4, 6, 2, 4, 6};
  double a[8];
  std::copy_n(v, 8, a);
  pcs::internal::unroll<19>([&](auto k) PCS_LAMBDA_INLINE {
    const double x = a[first[k]], y = a[second[k]];
    a[first[k]] = std::min(x, y);
    a[second[k]] = std::max(x, y);
  });
  std::copy_n(a, 8, v);
}

} // namespace internal

/// Returns the upper median of the lengths of the first 64 links of point `i`, 0 without links. It
/// is robust against a single outlier. [L]
inline double
median_link(const std::vector<Vec3>& points, const Proximity_graph& graph, std::size_t i)
{
  std::array<double, 64> squares;
  const std::size_t count = std::min(squares.size(), graph.degree(i));
  if (count == 0)
    return 0;
  for (std::size_t e = 0; e < count; ++e)
    squares[e] = (points[graph.begin(i)[e]] - points[i]).squaredNorm();
  if (count <= 8) {
    for (std::size_t e = count; e < 8; ++e)
      squares[e] = std::numeric_limits<double>::infinity();
    internal::sort_eight(squares.data());
  } else
    std::nth_element(squares.begin(),
                     squares.begin() + static_cast<std::ptrdiff_t>(count / 2),
                     squares.begin() + static_cast<std::ptrdiff_t>(count));
  return std::sqrt(squares[count / 2]);
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_MEDIAN_LINK_H
