// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Noise of a scan: deviation of points from planes through patches of the surface.

#ifndef PCS_SKELETON_SCAN_MEASURE_NOISE_H
#define PCS_SKELETON_SCAN_MEASURE_NOISE_H

#include <pcs/internal/median.h>
#include <pcs/internal/parallel.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/neighborhood/Nearest_neighbors.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

namespace internal {

/*!
  Returns the standard deviation of the points around point `i` from their plane, or infinity if
  there is no patch of a surface [L].

  With the eigenvalues `a <= b <= c` of the covariance of the `n` points within the distance `d`,
  the deviation is `sqrt(a n / (n - 3))`. `d` grows from the distance of the 16th point until the
  deviation is at most `d / 8`: smaller neighbourhoods show the noise, but not the surface. A patch
  of a surface is about as wide as it is long, `b >= c / 2`, and has at most 1 % of the points.
  Branches thinner than about eight times the noise have no patches.
*/
inline double deviation_from_plane(const std::vector<Vec3>& points,
                                   const neighborhood::Nearest_neighbors& search,
                                   std::size_t i)
{
  constexpr std::size_t fewest = 16; // [count]
  const std::size_t most = std::min<std::size_t>(4000, points.size() / 100);
  constexpr double growth = 1.4, thinnest = 8, widest = 2;
  const double unknown = std::numeric_limits<double>::infinity();
  std::vector<neighborhood::Nearest_neighbors::Neighbor> nearest;
  search(points[i], fewest, nearest);
  std::vector<Index> near;
  for (double reach = growth * std::sqrt(nearest.back().squared_distance);; reach *= growth) {
    near.clear();
    search.append_within(points[i], reach, near);
    if (near.size() < fewest || near.size() > most)
      return unknown;
    Vec3 mean = Vec3::Zero();
    const double n = double(near.size());
    for (const Index k : near)
      mean += (points[k] - points[i]) / n;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Index k : near) {
      const Vec3 d = points[k] - points[i] - mean;
      covariance += d * d.transpose() / n;
    }
    const Vec3 spread = linear_algebra::symmetric_eigen<3>(covariance).values;
    if (!(widest * spread[1] >= spread[2]))
      return unknown;
    const double deviation = std::sqrt(std::max(0.0, spread[0]) * n / (n - 3));
    if (thinnest * deviation <= reach)
      return deviation;
  }
}

} // namespace internal

/*!
  Returns the noise of the scan, or 0 if fewer than the fraction `flat` of the points lie on flat
  patches, since the deviations then show bark, leaves and curvature [L]. The noise is the lower
  quartile of the deviations from planes at an even sample of some two thousand points. `search` has
  the same points.
*/
template <class ConcurrencyTag>
double measure_noise(const std::vector<Vec3>& points,
                     const neighborhood::Nearest_neighbors& search,
                     double flat)
{
  constexpr std::size_t sample_size = 2000, fewest = 100; // [count]
  const std::size_t step = 1 + points.size() / sample_size;
  std::vector<double> deviations((points.size() + step - 1) / step);
  pcs::internal::for_each_index<ConcurrencyTag>(
      deviations.size(),
      [&](std::size_t k) {
        deviations[k] = internal::deviation_from_plane(points, search, k * step);
      },
      64);
  std::vector<double> known;
  for (const double d : deviations)
    if (std::isfinite(d))
      known.push_back(d);
  const double wanted = std::max(double(fewest), flat * double(deviations.size()));
  return double(known.size()) < wanted ? 0 : pcs::internal::value_of_rank(known, known.size() / 4);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_MEASURE_NOISE_H
