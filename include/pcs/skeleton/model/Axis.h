// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Branch axis (centerline): a polyline with radii, and coordinates of points relative to it.

#ifndef PCS_SKELETON_MODEL_AXIS_H
#define PCS_SKELETON_MODEL_AXIS_H

#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

struct Axis_node
{
  Vec3 point = Vec3::Zero();
  double radius = 0;        ///< [L]
  double radius_error = 0;  ///< standard error [L]
  bool is_measured = false; ///< the points, rather than the prior, determine the radius
};

/// Nodes from the base to the tip; at least one.
using Axis = std::vector<Axis_node>;

/// Projection of a point onto an axis.
struct Axis_place
{
  Index segment = 0; ///< between nodes `segment` and `segment + 1`
  //! parameter on the segment; outside of [0, 1] only before the first and beyond the last node
  double share = 0;
  double distance = 0; ///< of the point from the projection, clamped to the axis [L]
};

/// Segment of an axis, prepared for repeated projections.
struct Axis_segment
{
  Vec3 base, along;
  double inverse; ///< of the squared length; 0: no length [1/L^2]

  Axis_segment(const Axis_node& a, const Axis_node& b) : base(a.point), along(b.point - a.point)
  {
    const double length2 = along.squaredNorm();
    inverse = length2 > 0 ? 1 / length2 : 0;
  }

  /// Returns the parameter of the projection of `p` onto the line, not clamped.
  double share(const Vec3& p) const { return along.dot(p - base) * inverse; }
  double squared_distance(double share, const Vec3& p) const
  {
    const double clamped = std::min(1.0, std::max(0.0, share));
    return (p - base - clamped * along).squaredNorm();
  }
};

inline std::vector<Axis_segment> segments_of(const Axis& axis)
{
  std::vector<Axis_segment> segments;
  segments.reserve(axis.size());
  for (std::size_t s = 0; s + 1 < axis.size(); ++s)
    segments.emplace_back(axis[s], axis[s + 1]);
  return segments;
}

namespace internal {

/// Search for the segment that is nearest to a point. `segment_at(s)` returns segment `s`; `last`
/// is the index of the last segment.
template <class SegmentAt>
class Place_search
{
public:
  Place_search(std::size_t last, const SegmentAt& segment_at, const Vec3& p)
    : m_last(last), m_segment_at(segment_at), m_p(p)
  {
  }

  /// Returns whether segment `s` is nearer than all previous ones, and records it if so.
  bool offer(std::size_t s)
  {
    const Axis_segment& segment = m_segment_at(s);
    const double t = segment.share(m_p), d = segment.squared_distance(t, m_p);
    m_last_share = t;
    if (!(d < m_squared_distance))
      return false;
    m_squared_distance = d;
    m_share = t;
    m_segment = s;
    return true;
  }

  /// Visits the segments beyond `s` in one direction. Ends after several segments in a row that are
  /// not nearer, or after one of these that leads away from the point.
  template <bool IsForward>
  void walk(std::size_t s)
  {
    constexpr int most_misses = 2;
    for (int misses = 0; misses < most_misses && (IsForward ? s < m_last : s > 0);) {
      s = IsForward ? s + 1 : s - 1;
      misses = offer(s) ? 0 : misses + 1;
      if (misses > 0 && (IsForward ? m_last_share < 0 : m_last_share > 1))
        break;
    }
  }

  double distance() const { return std::sqrt(m_squared_distance); } ///< of the nearest one [L]

  Axis_place place() const
  {
    Axis_place place;
    place.segment = static_cast<Index>(m_segment);
    place.distance = distance();
    const bool is_open = (m_segment == 0 && m_share < 0) || (m_segment == m_last && m_share > 1);
    place.share = is_open ? m_share : std::min(1.0, std::max(0.0, m_share));
    return place;
  }

private:
  std::size_t m_last, m_segment = 0;
  const SegmentAt& m_segment_at;
  const Vec3& m_p;
  double m_squared_distance = std::numeric_limits<double>::infinity(), m_share = 0;
  double m_last_share = 0; ///< parameter on the segment visited last
};

} // namespace internal

/// Projects a point onto an axis, searching from segment `guess`. At least one segment.
inline Axis_place
nearest_place(const std::vector<Axis_segment>& segments, std::size_t guess, const Vec3& p)
{
  const auto segment_at = [&](std::size_t s) -> const Axis_segment& { return segments[s]; };
  const std::size_t last = segments.size() - 1, s = std::min(guess, last);
  internal::Place_search search(last, segment_at, p);
  search.offer(s);
  search.template walk<true>(s);
  search.template walk<false>(s);
  return search.place();
}

/// Projects a point without prepared segments, for few points. The axis has at least two nodes.
inline Axis_place nearest_place(const Axis& axis, std::size_t guess, const Vec3& p)
{
  const auto segment_at = [&](std::size_t s) { return Axis_segment(axis[s], axis[s + 1]); };
  const std::size_t last = axis.size() - 2, s = std::min(guess, last);
  internal::Place_search search(last, segment_at, p);
  search.offer(s);
  search.template walk<true>(s);
  search.template walk<false>(s);
  return search.place();
}

/// Projects a point onto the nearest of all segments. O(nodes).
inline Axis_place nearest_place(const Axis& axis, const Vec3& p)
{
  const auto segment_at = [&](std::size_t s) { return Axis_segment(axis[s], axis[s + 1]); };
  internal::Place_search search(axis.size() - 2, segment_at, p);
  for (std::size_t s = 0; s + 1 < axis.size(); ++s)
    search.offer(s);
  return search.place();
}

/// Projects many points onto the nearest of all segments of an axis. Balls around runs of segments
/// show which of these are too far away.
class Axis_projector
{
public:
  /// At least two nodes.
  explicit Axis_projector(const Axis& axis) : m_segments(segments_of(axis))
  {
    for (std::size_t begin = 0; begin < m_segments.size(); begin += run) {
      const std::size_t end = std::min(m_segments.size(), begin + run);
      Ball ball;
      ball.center = 0.5 * (axis[begin].point + axis[end].point);
      for (std::size_t k = begin; k <= end; ++k)
        ball.radius = std::max(ball.radius, (axis[k].point - ball.center).norm());
      m_balls.push_back(ball);
    }
  }

  /// Returns `nearest_place(axis, p)`. It is found faster if the segment `guess` is near.
  Axis_place operator()(std::size_t guess, const Vec3& p) const
  {
    constexpr double rounding = 1 + 1e-6;
    const auto segment_at = [&](std::size_t s) -> const Axis_segment& { return m_segments[s]; };
    const std::size_t last = m_segments.size() - 1;
    const Axis_segment& guessed = m_segments[std::min(guess, last)];
    double least = std::sqrt(guessed.squared_distance(guessed.share(p), p));
    internal::Place_search search(last, segment_at, p);
    for (std::size_t b = 0; b < m_balls.size(); ++b) {
      const double reach = rounding * (least + m_balls[b].radius);
      if ((p - m_balls[b].center).squaredNorm() > reach * reach)
        continue;
      const std::size_t end = std::min(m_segments.size(), (b + 1) * run);
      for (std::size_t s = b * run; s < end; ++s)
        search.offer(s);
      least = std::min(least, search.distance());
    }
    return search.place();
  }

private:
  struct Ball
  {
    Vec3 center;
    double radius = 0; ///< [L]
  };
  static constexpr std::size_t run = 8; ///< segments of a ball [count]

  std::vector<Axis_segment> m_segments;
  std::vector<Ball> m_balls;
};

/// Returns the points closer than `reach(k)` [L] to a node `k` of the axis, and those of `near`, in
/// increasing order.
template <class Reach>
std::vector<Index>
points_near(const Scan& scan, const Axis& axis, const Reach& reach, std::vector<Index> near = {})
{
  constexpr double rounding = 1 - 1e-9;
  double before = 0; // reach of the previous node
  for (std::size_t k = 0; k < axis.size(); ++k) {
    const double r = reach(k);
    const auto known = static_cast<std::ptrdiff_t>(near.size());
    scan.search->append_within(axis[k].point, r, near);
    const auto is_known = [&](Index i) {
      return k > 0 &&
             (scan.points[i] - axis[k - 1].point).squaredNorm() < rounding * before * before;
    };
    near.erase(std::remove_if(near.begin() + known, near.end(), is_known), near.end());
    before = r;
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
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

/// Interpolates the position and the radius at parameter `t` of segment `s`; all other values are
/// those of the nearer node.
inline Axis_node node_between(const Axis& axis, std::size_t s, double t)
{
  Axis_node node = t < 0.5 ? axis[s] : axis[s + 1];
  node.point = (1 - t) * axis[s].point + t * axis[s + 1].point;
  node.radius = (1 - t) * axis[s].radius + t * axis[s + 1].radius;
  return node;
}

/// Interpolates a node at `at`, the sum of a segment and a parameter in [0, 1].
inline Axis_node node_at(const Axis& axis, double at)
{
  const std::size_t s = std::min(axis.size() - 2, static_cast<std::size_t>(at));
  return node_between(axis, s, at - double(s));
}

/// Returns the length of the polyline [L].
inline double length_of(const Axis& axis)
{
  double sum = 0;
  for (std::size_t k = 1; k < axis.size(); ++k)
    sum += (axis[k].point - axis[k - 1].point).norm();
  return sum;
}

/// Distance between nodes: `factor` radii, clamped to [lowest, highest] [L].
struct Node_spacing
{
  double factor, lowest, highest;
  double operator()(double radius) const
  {
    return std::min(highest, std::max(lowest, factor * radius));
  }
};

/// Resamples an axis to the given distances between nodes. Keeps both ends.
inline Axis resample(const Axis& axis, const Node_spacing& spacing)
{
  if (axis.size() < 2)
    return axis;
  // cumulative integral of length / wanted distance, divided into equal steps
  std::vector<double> steps(axis.size(), 0);
  for (std::size_t k = 1; k < axis.size(); ++k) {
    const double wanted = spacing(0.5 * (axis[k].radius + axis[k - 1].radius));
    steps[k] = steps[k - 1] + (axis[k].point - axis[k - 1].point).norm() / wanted;
  }
  // limits the nodes of an axis across wide gaps, which have no points
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
    result.push_back(node_between(axis, s, span > 0 ? (at - steps[s]) / span : 0));
  }
  result.push_back(axis.back());
  return result;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_MODEL_AXIS_H
