// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The position where a branch leaves its parent.

#ifndef PCS_SKELETON_SURFACE_FIND_BRANCH_EXIT_H
#define PCS_SKELETON_SURFACE_FIND_BRANCH_EXIT_H

#include <pcs/skeleton/surface/Branch_surface.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcs {
namespace skeleton {

/// The position where the axis of a branch passes through the surface of its parent.
struct Branch_exit
{
  bool is_there = false; ///< otherwise only `start` is valid
  //! arc length on the axis of the parent, and half the length of the footprint along it [L]
  double at = 0, half = 0;
  double start = 0;  ///< arc length of the first ring of the branch; < 0: no surface [L]
  double radius = 0; ///< of the branch [L]
  //! on the axis of the branch [L]; unit vector along the branch, with its angle to the parent
  //! limited by `steepest`; outward unit normal of the parent
  Vec3 point = Vec3::Zero(), direction = Vec3::Zero(), normal = Vec3::Zero();
};

/// Finds the exit of a branch by bisection along its axis. `below` is the axis of the parent, or
/// null for a branch without parent. O(n m) for n sections of the branch and m of the parent.
inline Branch_exit
find_branch_exit(const Section_line& line, const Section_line* below, const Surface_options& rules)
{
  Branch_exit e;
  e.start = line.size() < 2 ? -1 : 0;
  if (line.size() < 2 || below == nullptr)
    return e;
  const auto outside = [&](double s) {
    const Vec3 p = line.section(s).center;
    const Section at = below->section(below->nearest(p));
    return (p - at.center).norm() - at.radius;
  };
  double low = 0, high = -1;
  for (std::size_t k = 0; k < line.size() && high < 0; ++k) {
    if (outside(line.at(k)) > 0)
      high = line.at(k);
    else
      low = line.at(k);
  }
  if (high < 0) { // entirely inside its parent
    e.start = -1;
    return e;
  }
  for (int k = 0; k < 30 && high > 0; ++k) {
    const double middle = 0.5 * (low + high);
    (outside(middle) > 0 ? high : low) = middle;
  }
  const Section here = line.section(high);
  e.point = here.center;
  e.radius = here.radius;
  e.at = below->nearest(here.center);
  const Section at = below->section(e.at);
  const Vec3 axis = below->direction(e.at);
  Vec3 normal = here.center - at.center;
  normal -= normal.dot(axis) * axis;
  e.normal =
      normal.norm() > 1e-9 * at.radius ? Vec3(normal.normalized()) : Vec3(axis.unitOrthogonal());
  // branches nearly parallel to their parent would have very long footprints
  const Vec3 d = line.direction(high);
  const double sine = std::max(rules.steepest, d.dot(e.normal));
  Vec3 flat = d - d.dot(e.normal) * e.normal;
  flat = flat.norm() > 1e-9 ? Vec3(flat.normalized()) : Vec3(Vec3::Zero());
  e.direction = (std::sqrt(1 - std::min(1.0, sine * sine)) * flat + sine * e.normal).normalized();
  const double rise = std::abs(flat.dot(axis)); // component of the slope along the parent
  e.half = e.radius * ((1 - rise) + rise / sine) + rules.margin * e.radius;
  const double slope = std::sqrt(1 - std::min(1.0, sine * sine)) / sine;
  const double sag = at.radius > e.radius // the parent curves away from the branch
                         ? at.radius - std::sqrt(at.radius * at.radius - e.radius * e.radius)
                         : e.radius;
  // the first ring of the branch lies entirely outside the parent
  e.start = high + std::max(0.0, slope * e.radius - sag) + rules.margin * e.radius;
  const double last = line.length();
  if (e.start > high + 0.6 * (last - high))
    e.start = high + 0.6 * (last - high);
  e.is_there = last - e.start > 1e-6 * (e.radius + last) || high == 0;
  if (!e.is_there)
    e.start = -1;
  return e;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SURFACE_FIND_BRANCH_EXIT_H
