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

namespace internal {

/// Squared lengths of the first 64 links of a point. Those before the upper median are not longer.
struct Link_squares
{
  std::array<double, 64> square;
  std::size_t count = 0;

  Link_squares(const std::vector<Vec3>& points, const Proximity_graph& graph, std::size_t i)
    : count(std::min(square.size(), graph.degree(i)))
  {
    for (std::size_t e = 0; e < count; ++e)
      square[e] = (points[graph.begin(i)[e]] - points[i]).squaredNorm();
    if (count <= 8) {
      for (std::size_t e = count; e < 8; ++e)
        square[e] = std::numeric_limits<double>::infinity();
      sort_eight(square.data());
    } else
      std::nth_element(begin(),
                       begin() + static_cast<std::ptrdiff_t>(count / 2),
                       begin() + static_cast<std::ptrdiff_t>(count));
  }

  double* begin() { return square.data(); }
  double median() const { return square[count / 2]; }
};

} // namespace internal

/// Returns the upper median of the lengths of the first 64 links of point `i`, 0 without links. It
/// is robust against a single outlier. [L]
inline double
median_link(const std::vector<Vec3>& points, const Proximity_graph& graph, std::size_t i)
{
  if (graph.degree(i) == 0)
    return 0;
  return std::sqrt(internal::Link_squares(points, graph, i).median());
}

/// Links of a group of points that are shorter than this fraction of a median link lead to points
/// of the same group, and longer links to other groups. [-]
constexpr double widest_group = 1e-3;
/// Smallest spacing in a group. Points that nearly coincide, as in overlapping scans, are no
/// structure of their own. [median links]
constexpr double least_group_spacing = 1e-6;

/*!
  Returns `median_link()` or, for a point of a small group, the median of its links in the group. A
  group has at least three points, and so few that most of their links lead to other groups, which
  are far away. The median of all links of its points would be the distance of another group for
  some points, and the size of the group for others. [L]
*/
inline double
group_spacing(const std::vector<Vec3>& points, const Proximity_graph& graph, std::size_t i)
{
  if (graph.degree(i) == 0)
    return 0;
  internal::Link_squares links(points, graph, i);
  const double median = links.median(), widest = widest_group * widest_group * median;
  double* const middle = links.begin() + links.count / 2;
  double* const end = std::partition(links.begin(), middle, [&](double s) { return s < widest; });
  const auto count = end - links.begin();
  if (count < 2)
    return std::sqrt(median);
  std::nth_element(links.begin(), links.begin() + count / 2, end);
  return std::sqrt(
      std::max(links.begin()[count / 2], least_group_spacing * least_group_spacing * median));
}

} // namespace neighborhood
} // namespace pcs

#endif // PCS_NEIGHBORHOOD_MEDIAN_LINK_H
