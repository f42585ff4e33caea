// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Thin-sheet test for groups of points and whole scans.

#ifndef PCS_SKELETON_CLUTTER_IS_SINGLE_SHEET_H
#define PCS_SKELETON_CLUTTER_IS_SINGLE_SHEET_H

#include <pcs/internal/constants.h>
#include <pcs/internal/median.h>
#include <pcs/linear_algebra/small_symmetric.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Slab_shape.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for points that form a filled sheet, and for scans that contain only a sheet.
struct Sheet_options
{
  int cells = 20;          ///< along the radius of a sheet [count]
  double thin = 0.1;       ///< largest ratio of the deviations across and along a sheet [-]
  double full = 0.7;       ///< least fraction of its cells that contain points [-]
  double longest = 8;      ///< largest ratio of its length to its width [-]
  double stray = 0.001;    ///< fraction of points that may be higher than a tree on it [-] ...
  std::size_t strays = 50; ///< ... and their largest number [count]
  double tall = 0.5;       ///< least ratio of that height to the horizontal deviation of the tree
  double outstanding = 10; ///< least ratio of that height to the median distance of all points [-]
};

namespace internal {

/// Disc of the nearest 90 % of points to `center`, in coordinates along `e1` and `e2` of a sheet.
/// The lengths of these vectors scale the coordinates, so that the disc may be an ellipse.
struct Sheet_disc
{
  std::vector<std::array<double, 2>> places; ///< relative to the center
  double radius = 0;

  Sheet_disc(const Scan& scan,
             const std::vector<Index>& points,
             const Vec3& center,
             const Vec3& e1,
             const Vec3& e2)
  {
    std::vector<double> distance;
    for (const Index i : points) {
      const Vec3 d = scan.points[i] - center;
      places.push_back({d.dot(e1), d.dot(e2)});
      distance.push_back(std::hypot(places.back()[0], places.back()[1]));
    }
    if (places.empty())
      return;
    radius = pcs::internal::value_of_rank(distance,
                                          static_cast<std::size_t>(0.9 * double(distance.size())));
    places.erase(std::remove_if(places.begin(),
                                places.end(),
                                [&](const auto& p) { return std::hypot(p[0], p[1]) > radius; }),
                 places.end());
  }

  /// Returns the side of a cell that contains `crowd` of the points in a uniform distribution.
  double cell_of(double crowd) const
  {
    return std::sqrt(crowd * area() / double(std::max<std::size_t>(1, places.size())));
  }

  /// Returns whether the fraction `share` of the cells of the disc contains points; `false` for few
  /// points or cells.
  bool is_filled(double cell, double share) const
  {
    const double all = area() / (cell * cell);
    if (places.size() < 90 || !(all > 12))
      return false;
    std::vector<std::pair<long, long>> cells;
    for (const auto& p : places)
      cells.emplace_back(std::lround(p[0] / cell), std::lround(p[1] / cell));
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return double(cells.size()) >= share * all;
  }

private:
  double area() const { return pcs::internal::pi * radius * radius; }
};

/// Returns whether a tree stands or lies on a sheet: few points that are high relative to their
/// width.
inline bool carries_a_tree(const Scan& scan,
                           const std::vector<Index>& points,
                           const Vec3& normal,
                           const Sheet_options& rules)
{
  std::vector<double> heights;
  for (const Index i : points)
    heights.push_back(normal.dot(scan.points[i]));
  std::vector<double> sorted = heights;
  const double level = pcs::internal::lower_median(sorted);
  for (double& h : heights)
    h = std::abs(h - level);
  sorted = heights;
  const double usual = pcs::internal::lower_median(sorted);
  const auto strays =
      std::min(rules.strays, static_cast<std::size_t>(rules.stray * double(sorted.size())));
  const double high = pcs::internal::value_of_rank(sorted, sorted.size() - 1 - strays);
  if (!(high > rules.outstanding * usual))
    return false;
  std::vector<Index> standing;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (heights[k] > rules.outstanding * usual)
      standing.push_back(points[k]);
  return high > rules.tall * Slab_shape(scan, standing, normal).width;
}

} // namespace internal

/// Returns whether all points form one thin filled sheet, such as ground or a wall. Sheets longer
/// than `rules.longest` widths are excluded, since they may be boards or rows of objects.
inline bool is_single_sheet(const Scan& scan,
                            const std::vector<std::uint8_t>& is_used,
                            const Sheet_options& rules)
{
  std::vector<Index> points;
  Vec3 mean = Vec3::Zero();
  for (Index i = 0; i < scan.size(); ++i)
    if (is_used[i]) {
      points.push_back(i);
      mean += scan.points[i];
    }
  if (points.empty())
    return false;
  mean /= double(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Index i : points)
    covariance += (scan.points[i] - mean) * (scan.points[i] - mean).transpose();
  const auto eigen = linear_algebra::symmetric_eigen<3>(covariance / double(points.size()));
  const Vec3 spread = eigen.values.cwiseMax(0).cwiseSqrt();
  if (!(spread(0) < rules.thin * spread(1)) || !(spread(2) < rules.longest * spread(1)))
    return false;
  if (internal::carries_a_tree(scan, points, eigen.vectors.col(0), rules))
    return false;
  const Vec3 across = spread(2) / spread(1) * eigen.vectors.col(1), along = eigen.vectors.col(2);
  const internal::Sheet_disc disc(scan, points, mean, along, across);
  const double longest = std::max(along.norm(), across.norm());
  return disc.is_filled(std::max(disc.radius / rules.cells, 3 * scan.spacing * longest),
                        rules.full);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_IS_SINGLE_SHEET_H
