// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Radii along a given skeleton.

#ifndef PCS_SKELETON_RADII_MEASURE_GIVEN_H
#define PCS_SKELETON_RADII_MEASURE_GIVEN_H

#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Branch_grouper.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Given_skeleton.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/model/circle_fit.h>
#include <pcs/skeleton/model/nearest_edge.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for the assignment of points to edges and for circles through these points.
struct Given_skeleton_options
{
  double reach = 2,
         reach_offset = 4; ///< largest distance of points from the edge, in radii plus spacings [-]
  int sectors = 5;         ///< least number of sectors, of 12, with points [count]
  double deviation = 0.25; ///< largest deviation of a circle, in radii
  double widening =
      /// largest radius of a circle or of a detected branch, in median distances from the edge [-]
      1.5;
  double inside =
      1.3; ///< nodes within this many parent radii of the base lie inside the parent [-]
  std::size_t lowest_count = 3; ///< least number of points for the radius of an edge [count]
  double thicker = 1.5; ///< largest ratio of the radius of a circle to the last one below [-]
  double slack = 1.5;   ///< largest change of a radius by points without a circle, as a factor [-]
  double found_thicker =
      1.3; ///< largest ratio of the radius of a detected branch to the median distance [-]
  double aligned = 0.7; ///< least cosine between an edge and a detected branch along it [-]
};

namespace internal {

class Given_measurement
{
public:
  Given_measurement(const Scan& scan,
                    const std::vector<std::uint8_t>& is_used,
                    const Given_skeleton& given,
                    const Branch_tree& found,
                    const Given_skeleton_options& rules)
    : m_scan(scan), m_is_used(is_used), m_found(found), m_parent(given.parent), m_rules(rules)
  {
    for (const Vec3& p : given.points)
      m_nodes.push_back(scan.frame.to_local(p));
  }

  Branch_tree operator()()
  {
    const std::size_t n = m_nodes.size();
    m_radius.assign(n, 0);
    m_error.assign(n, 0);
    m_is_measured.assign(n, 0);
    m_found_radius.assign(n, 0);
    m_found_node.assign(n, none);
    std::vector<Branch_node> nodes = measured();
    if (!m_found.nodes.empty()) {
      const std::vector<Branch_node> alone = std::move(nodes);
      take_found();
      nodes = measured();
      for (std::size_t v = 0; v < n; ++v) // branches in a sparse scan may be far too thick
        if (nodes[v].radius > m_rules.found_thicker * alone[v].radius)
          nodes[v] = alone[v];
    }
    Branch_grouper group(std::move(nodes), m_scan.spacing);
    Branch_tree tree = group();
    leave_parents(tree);
    tree.node_of_point.assign(m_scan.size(), none);
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      if (m_edge_of_point[i] != none)
        tree.node_of_point[i] = group.number()[m_edge_of_point[i]];
    return tree;
  }

private:
  std::vector<Branch_node> measured()
  {
    assign_to_nearest();
    measure();
    assign_to_surfaces();
    measure();
    std::vector<Branch_node> nodes(m_nodes.size());
    fill_gaps(nodes);
    return nodes;
  }

  /// Replaces the radii of branch nodes inside the parent by the radius of the first node outside,
  /// since points inside belong to the parent.
  void leave_parents(Branch_tree& tree) const
  {
    for (const Branch& branch : tree.branches) {
      if (branch.parent == none)
        continue;
      const Branch_node& base = tree.nodes[branch.nodes.front()];
      const double inside = m_rules.inside * tree.nodes[base.parent].radius;
      std::size_t k = 0;
      while (k < branch.nodes.size() &&
             (tree.nodes[branch.nodes[k]].point - base.point).norm() <= inside)
        ++k;
      for (std::size_t j = 0; j < k && k < branch.nodes.size(); ++j) {
        Branch_node& node = tree.nodes[branch.nodes[j]];
        node.radius = tree.nodes[branch.nodes[k]].radius;
        node.radius_error = node.radius;
        node.is_measured = false;
      }
    }
  }

  /// Returns the distance of a point from the edge to `v`; the edge of the root is a point.
  double distance(Index v, const Vec3& p) const
  {
    const Vec3& a = m_nodes[m_parent[v] == none ? v : m_parent[v]];
    const Vec3 d = m_nodes[v] - a;
    const double l2 = d.squaredNorm();
    const double t = l2 > 0 ? std::min(1.0, std::max(0.0, d.dot(p - a) / l2)) : 0;
    return (p - a - t * d).norm();
  }

  /// Takes the radius of each node from the nearest measured position on a detected branch. The
  /// branch must be aligned with the edge, and the node must lie inside it or within one spacing of
  /// its axis.
  void take_found()
  {
    const std::vector<Index> next = successors(m_found);
    std::vector<Vec3> samples, direction;
    std::vector<Index> node;
    for (Index u = 0; u < m_found.nodes.size(); ++u) {
      if (next[u] == none || !m_found.nodes[u].is_measured)
        continue;
      const Vec3 &a = m_found.nodes[u].point, d = m_found.nodes[next[u]].point - a;
      if (!(d.norm() > 0))
        continue;
      constexpr double most = 1000;
      const double steps = std::min(most, 1 + std::ceil(d.norm() / m_scan.spacing));
      for (double k = 0; k <= steps; ++k) {
        samples.push_back(a + k / steps * d);
        direction.push_back(d.normalized());
        node.push_back(2 * k <= steps ? u : next[u]);
      }
    }
    if (samples.empty())
      return;
    const neighborhood::Nearest_neighbors search(samples);
    for (Index v = 0; v < m_nodes.size(); ++v) {
      if (m_parent[v] == none)
        continue;
      const Vec3 d = m_nodes[v] - m_nodes[m_parent[v]];
      const double least = m_rules.aligned * d.norm();
      const auto near =
          search.nearest_if(m_nodes[v], std::numeric_limits<double>::max(), [&](Index s) {
            return std::abs(direction[s].dot(d)) > least;
          });
      if (!std::isfinite(near.squared_distance))
        continue;
      const Place_on_edge place =
          nearest_edge(m_found, next, node[near.index], m_nodes[v], Base_edge::left_out);
      if (std::sqrt(place.squared_distance) <= std::max(place.radius, m_scan.spacing)) {
        m_found_radius[v] = place.radius;
        m_found_node[v] = node[near.index];
      }
    }
  }

  /// Assigns the points to the edges with the nearest axis, as an initial guess.
  void assign_to_nearest()
  {
    std::vector<Vec3> samples;
    std::vector<Index> edge;
    for (Index v = 0; v < m_nodes.size(); ++v) {
      const Vec3& a = m_nodes[m_parent[v] == none ? v : m_parent[v]];
      const double length = (m_nodes[v] - a).norm();
      constexpr double most = 1000;
      const double steps = std::min(most, std::ceil(length / (2 * m_scan.spacing)));
      for (double k = m_parent[v] == none ? 0 : 1; k <= steps; ++k) {
        samples.push_back(a + k / std::max(1.0, steps) * (m_nodes[v] - a));
        edge.push_back(v);
      }
    }
    const neighborhood::Nearest_neighbors search(samples);
    m_edge_of_point.assign(m_scan.size(), none);
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i]) {
        const auto near = search.nearest_if(m_scan.points[i],
                                            std::numeric_limits<double>::max(),
                                            [](Index) { return true; });
        m_edge_of_point[i] = edge[near.index];
      }
  }

  /// Assigns the points to the edges with the nearest surface within reach, by the current radii.
  void assign_to_surfaces()
  {
    std::vector<double> best(m_scan.size(), std::numeric_limits<double>::infinity());
    std::vector<Index> near;
    m_edge_of_point.assign(m_scan.size(), none);
    for (Index v = 0; v < m_nodes.size(); ++v) {
      if (m_parent[v] == none || !(m_radius[v] > 0))
        continue;
      const Vec3 &a = m_nodes[m_parent[v]], d = m_nodes[v] - a;
      const double reach = m_rules.reach * m_radius[v] + m_rules.reach_offset * m_scan.spacing;
      const double pieces = std::min(1000.0, std::max(1.0, std::ceil(d.norm() / (2 * reach))));
      const double half = 0.5 * d.norm() / pieces;
      for (double k = 0; k < pieces; ++k) {
        near.clear();
        m_scan.search->within(a + (k + 0.5) / pieces * d, std::hypot(half, reach), near);
        for (const Index i : near) {
          if (!m_is_used[i])
            continue;
          const double distance_i = distance(v, m_scan.points[i]);
          const double off = std::abs(distance_i - m_radius[v]);
          if (distance_i <= reach && off < best[i]) {
            best[i] = off;
            m_edge_of_point[i] = v;
          }
        }
      }
    }
  }

  /// Computes the radius of each edge from a detected branch, from a circle through its points, or
  /// as the median of their distances.
  void measure()
  {
    const std::size_t n = m_nodes.size();
    std::vector<std::vector<Index>> points(n);
    for (Index i = 0; i < m_edge_of_point.size(); ++i)
      if (m_edge_of_point[i] != none)
        points[m_edge_of_point[i]].push_back(i);
    for (Index v = 0; v < n; ++v) {
      m_radius[v] = m_error[v] = 0;
      m_is_measured[v] = 0;
      if (m_parent[v] == none)
        continue;
      const auto use_found = [&] {
        m_radius[v] = m_found_radius[v];
        m_error[v] = m_found.nodes[m_found_node[v]].radius_error;
        m_is_measured[v] = 1;
      };
      if (points[v].size() < m_rules.lowest_count) {
        if (m_found_radius[v] > 0)
          use_found();
        continue;
      }
      const Vec3 &a = m_nodes[m_parent[v]], d = m_nodes[v] - a;
      std::vector<double> distances;
      for (const Index i : points[v])
        distances.push_back(distance(v, m_scan.points[i]));
      const double count = double(distances.size());
      m_radius[v] = pcs::internal::lower_median(distances);
      double deviation = 0;
      for (const double x : distances)
        deviation += std::abs(x - m_radius[v]) / count;
      m_error[v] = std::max(deviation, 1e-3 * m_scan.spacing) / std::sqrt(count);
      m_radius[v] = std::max(m_radius[v], 0.05 * m_scan.spacing);
      if (m_found_radius[v] > 0 && m_found_radius[v] <= m_rules.widening * m_radius[v]) {
        use_found();
        continue;
      }
      if (!(d.norm() > 0))
        continue;
      const Vec3 along = d.normalized(), e1 = along.unitOrthogonal(), e2 = along.cross(e1);
      std::vector<Vec2> plane;
      for (const Index i : points[v])
        plane.emplace_back((m_scan.points[i] - a).dot(e1), (m_scan.points[i] - a).dot(e2));
      const Circle c = fit_circle(plane);
      if (!(c.radius > 0) || c.deviation > m_rules.deviation * c.radius ||
          c.radius > m_rules.widening * m_radius[v] ||
          covered_sectors(plane, c.center) < m_rules.sectors)
        continue;
      m_radius[v] = c.radius;
      m_error[v] = std::max(c.deviation, 1e-3 * m_scan.spacing) / std::sqrt(count);
      m_is_measured[v] = 1;
    }
  }

  /// Returns the length of the longest path from the middle of each edge to a tip.
  std::vector<double> ways_to_tips() const
  {
    const std::size_t n = m_nodes.size();
    std::vector<double> way(n, 0);
    for (std::size_t v = n; v-- > 0;) {
      const Index p = m_parent[v];
      const double length = p == none ? 0 : (m_nodes[v] - m_nodes[p]).norm();
      if (p != none)
        way[p] = std::max(way[p], way[v] + length);
      way[v] += 0.5 * length; // its children are complete
    }
    return way;
  }

  /// Returns the largest radius among the next measured cross-sections towards the tips, or 0.
  std::vector<double> circles_farther_out() const
  {
    std::vector<double> radius(m_nodes.size(), 0);
    for (std::size_t v = m_nodes.size(); v-- > 1;)
      if (m_parent[v] != none) {
        double& r = radius[m_parent[v]];
        r = std::max(r, m_is_measured[v] ? m_radius[v] : radius[v]);
      }
    return radius;
  }

  /*!
  Computes the radii of the nodes from the radii of the edges. Nodes with neither a detected branch
  nor a circle get the last measured radius towards the root, reduced in proportion to the remaining
  length to the tip. The result is not less than the next measured radius towards the tip. The few
  points at such an edge may belong to other branches; they change the radius by at most a factor of
  `slack`.
  */
  void fill_gaps(std::vector<Branch_node>& nodes) const
  {
    const std::size_t n = m_nodes.size();
    const std::vector<double> way = ways_to_tips(), farther_out = circles_farther_out();
    std::vector<double> radius_below(n, 0), way_below(n, 0);
    for (std::size_t v = 0; v < n; ++v) {
      Branch_node& node = nodes[v];
      const Index p = m_parent[v];
      node.point = m_nodes[v];
      node.parent = p;
      const double below = p == none ? 0 : radius_below[p];
      const bool is_circle =
          m_is_measured[v] && (!(below > 0) || m_radius[v] <= m_rules.thicker * below);
      if (is_circle) {
        node.radius = radius_below[v] = m_radius[v];
        way_below[v] = way[v];
        node.radius_error = m_error[v];
        node.is_measured = true;
        continue;
      }
      radius_below[v] = below;
      way_below[v] = p == none ? 0 : way_below[p];
      if (below > 0) {
        const double taper = below * std::min(1.0, way[v] / way_below[v]);
        node.radius = std::max(taper, std::min(below, farther_out[v]));
        if (m_radius[v] > 0)
          node.radius = std::max(std::min(m_radius[v], m_rules.slack * node.radius),
                                 node.radius / m_rules.slack);
      } else {
        node.radius = m_radius[v] > 0      ? m_radius[v]
                      : farther_out[v] > 0 ? farther_out[v]
                                           : m_scan.spacing; // no point is near
      }
      node.radius_error = std::max(node.radius, m_error[v]);
    }
  }

  const Scan& m_scan;
  const std::vector<std::uint8_t>& m_is_used;
  const Branch_tree& m_found;
  std::vector<Vec3> m_nodes;
  std::vector<Index> m_parent, m_edge_of_point;
  Given_skeleton_options m_rules;
  std::vector<double> m_radius, m_error;
  std::vector<double> m_found_radius; ///< 0: no branch was detected
  std::vector<Index> m_found_node;
  std::vector<std::uint8_t> m_is_measured;
};

} // namespace internal

/// Computes branches and radii along a given skeleton without moving its nodes. `found` is the
/// skeleton detected from the same points, or empty. O(n log n) if edges are about as long as wide.
inline Branch_tree measure_given(const Scan& scan,
                                 const std::vector<std::uint8_t>& is_used,
                                 const Given_skeleton& given,
                                 const Branch_tree& found,
                                 const Given_skeleton_options& rules)
{
  return internal::Given_measurement(scan, is_used, given, found, rules)();
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_RADII_MEASURE_GIVEN_H
