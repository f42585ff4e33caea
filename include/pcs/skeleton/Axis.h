// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The axis of a branch: a polyline with radii, and where a point lies relative to it.

#ifndef PCS_SKELETON_AXIS_H
#define PCS_SKELETON_AXIS_H

#include <pcs/skeleton/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pcs {
namespace skeleton {

struct Axis_node
{
  Vec3 point = Vec3::Zero();
  double radius = 0;        ///< [L]
  double radius_error = 0;  ///< standard error [L]
  bool is_measured = false; ///< the points decide the radius, not the prior
};

/// At least one node; the base first.
using Axis = std::vector<Axis_node>;

/// The place of an axis that is nearest to a point.
struct Axis_place
{
  Index segment = 0; ///< between nodes `segment` and `segment + 1`
  double share =
      0; ///< position on the segment; outside of [0, 1] only before the first and behind the last node
  double distance = 0; ///< from the place clamped to the axis [L]
};

/// The foot of `p` on segment `s`, clamped to it.
inline Axis_place foot_on_segment(const Axis& axis, std::size_t s, const Vec3& p)
{
  const Vec3 a = axis[s].point, d = axis[s + 1].point - a;
  const double length2 = d.squaredNorm();
  const double t = length2 > 0 ? d.dot(p - a) / length2 : 0;
  const double clamped = std::min(1.0, std::max(0.0, t));
  Axis_place place;
  place.segment = static_cast<Index>(s);
  place.distance = (p - a - clamped * d).norm();
  const bool is_open = (s == 0 && t < 0) || (s + 2 == axis.size() && t > 1);
  place.share = is_open ? t : clamped;
  return place;
}

/// Walks from segment `guess` to the nearest one. The axis has at least two nodes.
inline Axis_place nearest_place(const Axis& axis, std::size_t guess, const Vec3& p)
{
  const std::size_t last = axis.size() - 2;
  std::size_t s = std::min(guess, last);
  Axis_place best = foot_on_segment(axis, s, p);
  const auto walk = [&](int step) {
    int misses = 0;
    for (std::size_t k = s; step > 0 ? k < last : k > 0;) {
      k = step > 0 ? k + 1 : k - 1;
      const Axis_place place = foot_on_segment(axis, k, p);
      if (place.distance < best.distance) {
        best = place;
        misses = 0;
      } else if (++misses == 2)
        break;
    }
  };
  walk(1);
  walk(-1);
  return best;
}

/// The nearest of all segments. O(nodes).
inline Axis_place nearest_place(const Axis& axis, const Vec3& p)
{
  Axis_place best = foot_on_segment(axis, 0, p);
  for (std::size_t s = 1; s + 1 < axis.size(); ++s) {
    const Axis_place place = foot_on_segment(axis, s, p);
    if (place.distance < best.distance)
      best = place;
  }
  return best;
}

inline double radius_at(const Axis& axis, const Axis_place& place)
{
  const double t = std::min(1.0, std::max(0.0, place.share));
  return (1 - t) * axis[place.segment].radius + t * axis[place.segment + 1].radius;
}

inline Vec3 point_at(const Axis& axis, const Axis_place& place)
{
  const double t = std::min(1.0, std::max(0.0, place.share));
  return (1 - t) * axis[place.segment].point + t * axis[place.segment + 1].point;
}

/// Length along the nodes.
inline double length_of(const Axis& axis)
{
  double sum = 0;
  for (std::size_t k = 1; k < axis.size(); ++k)
    sum += (axis[k].point - axis[k - 1].point).norm();
  return sum;
}

/// Nodes closer than `factor` radii, but not than `lowest`, and not farther than `highest`.
struct Node_spacing
{
  double factor, lowest, highest;
  double operator()(double radius) const
  {
    return std::min(highest, std::max(lowest, factor * radius));
  }
};

/// The same line with nodes at the wanted distances; both ends stay.
inline Axis resample(const Axis& axis, const Node_spacing& spacing)
{
  if (axis.size() < 2)
    return axis;
  // "Number of steps" as a running integral of length / wanted distance, then equal steps of it.
  std::vector<double> steps(axis.size(), 0);
  for (std::size_t k = 1; k < axis.size(); ++k) {
    const double wanted = spacing(0.5 * (axis[k].radius + axis[k - 1].radius));
    steps[k] = steps[k - 1] + (axis[k].point - axis[k - 1].point).norm() / wanted;
  }
  // an axis across wide gaps has no use for more nodes than these: nothing is there
  const double most = 4.0 * double(axis.size()) + 64;
  const std::size_t count =
      static_cast<std::size_t>(std::max(1.0, std::min(most, std::round(steps.back()))));
  Axis result;
  result.reserve(count + 1);
  result.push_back(axis.front());
  std::size_t s = 0;
  for (std::size_t k = 1; k < count; ++k) {
    const double at = steps.back() * double(k) / double(count);
    while (s + 2 < axis.size() && steps[s + 1] < at)
      ++s;
    const double span = steps[s + 1] - steps[s];
    const double t = span > 0 ? (at - steps[s]) / span : 0;
    Axis_node node = t < 0.5 ? axis[s] : axis[s + 1];
    node.point = (1 - t) * axis[s].point + t * axis[s + 1].point;
    node.radius = (1 - t) * axis[s].radius + t * axis[s + 1].radius;
    result.push_back(node);
  }
  result.push_back(axis.back());
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_AXIS_H
