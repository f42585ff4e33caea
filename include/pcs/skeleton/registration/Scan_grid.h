// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Angular grid of a terrestrial laser scanner.

#ifndef PCS_SKELETON_REGISTRATION_SCAN_GRID_H
#define PCS_SKELETON_REGISTRATION_SCAN_GRID_H

#include <pcs/internal/constants.h>
#include <pcs/internal/fast_atan2.h>
#include <pcs/skeleton/model/Scan.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace pcs {
namespace skeleton {

constexpr double two_pi = 2 * pcs::internal::pi;

/// A column and a row of a grid, as real numbers [steps].
using Grid_place = Eigen::Vector2d;

/// Returns the difference from the nearest integer, in [-1/2, 1/2].
inline double beyond_whole(double x)
{
  return x - std::nearbyint(x);
}

/*!
  The grid of beam directions of a scanner station. The scanner turns by equal steps about its own
  vertical, and its beam rises by equal steps. Range errors move points along their beams, so that
  columns and rows remain integers.
*/
struct Scan_grid
{
  Vec3 position = Vec3::Zero(); ///< of the station, including its registration error [L]
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity(); ///< rows: towards the tree, left, vertical
  Grid_place rate = Grid_place::Ones();               ///< of columns and rows [1/rad]
  Grid_place phase = Grid_place::Zero();              ///< added to them [steps]
  double tolerance = 0; ///< largest misfit of points of the station [steps]

  Grid_place place_of_direction(const Vec3& q) const
  {
    const double level = std::sqrt(q.x() * q.x() + q.y() * q.y());
    return Grid_place(rate[0] * fast_atan2(q.y(), q.x()), rate[1] * fast_atan2(q.z(), level)) +
           phase;
  }
  Grid_place place(const Vec3& p) const { return place_of_direction(axes * (p - position)); }

  /// Returns the larger distance of column and row from integers, in [0, 1/2] [steps]. If it
  /// exceeds `most`, the result is only a lower bound above `most`.
  double misfit(const Vec3& p, double most = 0.5) const
  {
    const Vec3 q = axes * (p - position);
    const double column = std::abs(beyond_whole(rate[0] * fast_atan2(q.y(), q.x()) + phase[0]));
    if (column > most) // most points of other stations
      return column;
    const double level = std::sqrt(q.x() * q.x() + q.y() * q.y());
    const double row = std::abs(beyond_whole(rate[1] * fast_atan2(q.z(), level) + phase[1]));
    return std::max(column, row);
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_REGISTRATION_SCAN_GRID_H
