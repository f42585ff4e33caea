// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// All fitted axes, the points that they explain, and the scan statistics learned from them.

#ifndef PCS_SKELETON_MODEL_AXIS_SET_H
#define PCS_SKELETON_MODEL_AXIS_SET_H

#include <pcs/skeleton/model/Axis.h>
#include <pcs/skeleton/model/Density_field.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/Visibility_field.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

/// Axis with its parent and the certainty of its direction.
struct Fitted_axis
{
  Axis axis;
  Index parent = none; ///< next axis on the paths to the root
  std::size_t number_of_points = 0;
  double direction = 1;    ///< certainty of the base: 0 if its pieces disagree evenly [-]
  std::size_t meeting = 0; ///< node between two pieces of opposite directions; 0: none
};

struct Axis_set
{
  std::vector<Fitted_axis> axes;
  std::vector<Index> axis_of_point; ///< `none`: not explained by any axis
  std::vector<Index> segment_of_point;
  double noise = 0;   ///< standard deviation of points from the surface [L]
  double density = 0; ///< median of points per area of the surface; 0: not known yet [1/L^2]
  Density_field density_field;
  Visibility_field facing_field;

  /// Returns the points per area of a branch at `place` along the unit vector `along` [1/L^2].
  double density_at(const Vec3& place, const Vec3& along) const
  {
    return density_field.is_known() ? density_field(place, along) : density;
  }
  /// Returns the points per area at a node of an axis [1/L^2].
  double density_at(const Axis& axis, std::size_t k) const
  {
    const Vec3 d = axis[std::min(axis.size() - 1, k + 1)].point - axis[k > 0 ? k - 1 : 0].point;
    const double length = d.norm();
    return density_at(axis[k].point, length > 0 ? Vec3(d / length) : Vec3(Vec3::UnitZ()));
  }
  /// Returns the expected mean outward normal of the points at a node; zero if it is not known.
  Vec3 visibility_at(const Axis& axis, std::size_t k) const
  {
    const Vec3 d = axis[std::min(axis.size() - 1, k + 1)].point - axis[k > 0 ? k - 1 : 0].point;
    const double length = d.norm();
    const bool is_known = facing_field.is_known() && length > 0;
    return is_known ? facing_field(axis[k].point, d / length) : Vec3(Vec3::Zero());
  }

  bool is_covered(Index i) const { return axis_of_point[i] != none; }

  /// Returns the signed distance of `p` from the surface of the axis that explains point `i`;
  /// negative inside [L].
  double height_above(Index i, const Vec3& p) const
  {
    const Axis& axis = axes[axis_of_point[i]].axis;
    const Axis_place place = nearest_place(axis, segment_of_point[i], p);
    return place.distance - radius_at(axis, place);
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_AXIS_SET_H
