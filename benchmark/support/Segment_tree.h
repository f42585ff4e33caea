// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Axis pieces with radii in a tree of bounding boxes: finds the nearest axis and the nearest
// surface of a point.

#ifndef PCS_BENCHMARK_SUPPORT_SEGMENT_TREE_H
#define PCS_BENCHMARK_SUPPORT_SEGMENT_TREE_H

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs_bench {

/// Straight piece of an axis with a linearly changing radius.
struct Axis_segment
{
  Eigen::Vector3d from, to;
  double radius_from = 0, radius_to = 0;
  std::size_t branch = 0; ///< index in its tree
  bool is_seen = true;    ///< whether the scan has a point here

  double length() const { return (to - from).norm(); }
  double radius(double t) const { return radius_from + t * (radius_to - radius_from); }
  /// Parameter in [0, 1] of the point nearest to `p`.
  double parameter(const Eigen::Vector3d& p) const
  {
    const Eigen::Vector3d d = to - from;
    const double square = d.squaredNorm();
    return square > 0 ? std::clamp((p - from).dot(d) / square, 0.0, 1.0) : 0.0;
  }
};

class Segment_tree
{
public:
  struct Hit
  {
    std::size_t segment = std::numeric_limits<std::size_t>::max();
    double t = 0;                                              ///< parameter on the segment
    double distance = std::numeric_limits<double>::infinity(); ///< to the axis or the surface
    bool is_found() const { return std::isfinite(distance); }
  };

  explicit Segment_tree(const std::vector<Axis_segment>& segments) : m_segments(segments)
  {
    m_order.resize(segments.size());
    for (std::size_t i = 0; i < m_order.size(); ++i)
      m_order[i] = i;
    if (!segments.empty())
      build(0, m_order.size());
  }

  /// The nearest point of all axes; the lowest segment in case of ties.
  Hit nearest_axis(const Eigen::Vector3d& p) const
  {
    return search(
        [&](const Node& node) { return std::sqrt(node.box.squaredExteriorDistance(p)); },
        [&](const Axis_segment& s, double t) { return (s.from + t * (s.to - s.from) - p).norm(); },
        p);
  }

  /// The nearest surface of all tubes around the axes, each measured perpendicular to its axis.
  Hit nearest_surface(const Eigen::Vector3d& p) const
  {
    return search(
        [&](const Node& node) {
          const double nearest = std::sqrt(node.box.squaredExteriorDistance(p));
          const Eigen::Vector3d far =
              (p - node.box.min()).cwiseAbs().cwiseMax((p - node.box.max()).cwiseAbs());
          return std::max({0.0, nearest - node.max_radius, node.min_radius - far.norm()});
        },
        [&](const Axis_segment& s, double t) {
          return std::abs((s.from + t * (s.to - s.from) - p).norm() - s.radius(t));
        },
        p);
  }

private:
  struct Node
  {
    Eigen::AlignedBox3d box;
    double min_radius = std::numeric_limits<double>::infinity(), max_radius = 0;
    std::size_t begin = 0, end = 0; // range in m_order, for a leaf
    std::size_t right = 0;          // the left child follows its parent; 0 for a leaf
  };
  static constexpr std::size_t leaf_size = 4;

  std::size_t build(std::size_t begin, std::size_t end)
  {
    const std::size_t index = m_nodes.size();
    m_nodes.emplace_back();
    Node node;
    node.begin = begin;
    node.end = end;
    Eigen::AlignedBox3d centers;
    for (std::size_t i = begin; i < end; ++i) {
      const Axis_segment& s = m_segments[m_order[i]];
      node.box.extend(s.from).extend(s.to);
      node.min_radius = std::min({node.min_radius, s.radius_from, s.radius_to});
      node.max_radius = std::max({node.max_radius, s.radius_from, s.radius_to});
      centers.extend(0.5 * (s.from + s.to));
    }
    if (end - begin > leaf_size) {
      Eigen::Index axis = 0;
      centers.sizes().maxCoeff(&axis);
      const std::size_t middle = begin + (end - begin) / 2;
      const auto key = [&](std::size_t i) {
        return m_segments[i].from[axis] + m_segments[i].to[axis];
      };
      const auto at = [&](std::size_t i) {
        return m_order.begin() + static_cast<std::ptrdiff_t>(i);
      };
      std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
        return std::make_pair(key(a), a) < std::make_pair(key(b), b);
      });
      build(begin, middle);
      node.right = build(middle, end);
    }
    m_nodes[index] = node;
    return index;
  }

  template <class Bound, class Distance>
  Hit search(const Bound& bound, const Distance& distance, const Eigen::Vector3d& p) const
  {
    Hit best;
    if (m_nodes.empty())
      return best;
    std::vector<std::pair<double, std::size_t>> stack = {{bound(m_nodes[0]), 0}};
    while (!stack.empty()) {
      const auto [least, index] = stack.back();
      stack.pop_back();
      if (least > best.distance)
        continue;
      const Node& node = m_nodes[index];
      if (node.right == 0) {
        for (std::size_t i = node.begin; i < node.end; ++i) {
          const double t = m_segments[m_order[i]].parameter(p);
          const double d = distance(m_segments[m_order[i]], t);
          if (d < best.distance || (d == best.distance && m_order[i] < best.segment))
            best = {m_order[i], t, d};
        }
        continue;
      }
      std::pair<double, std::size_t> near(bound(m_nodes[index + 1]), index + 1);
      std::pair<double, std::size_t> far(bound(m_nodes[node.right]), node.right);
      if (far.first < near.first)
        std::swap(near, far);
      stack.push_back(far);
      stack.push_back(near);
    }
    return best;
  }

  std::vector<Axis_segment> m_segments;
  std::vector<std::size_t> m_order;
  std::vector<Node> m_nodes;
};

} // namespace pcs_bench

#endif // PCS_BENCHMARK_SUPPORT_SEGMENT_TREE_H
