// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Merging of level-set components that are arcs of one cross-section.

#ifndef PCS_SKELETON_LAYERS_MERGE_RING_ARCS_H
#define PCS_SKELETON_LAYERS_MERGE_RING_ARCS_H

#include <pcs/skeleton/layers/cut_layers.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/circle_fit.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Criteria for level-set components that are arcs of one ring.
struct Ring_arc_options
{
  double smallest = 4;      ///< radius of a ring, in spacings [-]
  double band = 0.2;        ///< half width of the ring, in radii ...
  double band_offset = 1.5; ///< ... and spacings
  double share = 0.75;      ///< least fraction of the points of an arc in the band [-]
  double main_share =
      0.4;              ///< the same for the arc with the most points, where a branch may begin [-]
  double lasting = 2;   ///< least radius of a ring that may end a branch, in `smallest` [-]
  double growth = 1.1;  ///< largest growth of a radius between level sets [-]
  int age = 8;          ///< least number of level sets of a ring that may end a branch [count]
  double inertia = 0.7; ///< weight of the previous radius and centre [-]
  int sectors = 6;      ///< least number of sectors, of 12, with points to correct the centre
};

namespace internal {

/// The cross-section of a node, as predicted from the previous nodes.
struct Ring
{
  Vec3 center = Vec3::Zero(), along = Vec3::Zero();
  double radius = 0; ///< 0: no ring
  int age = 0;       ///< level sets with this ring [count]
};

class Ring_arc_merger
{
public:
  Ring_arc_merger(const Scan& scan, const Layer_tree& tree, const Ring_arc_options& rules)
    : m_scan(scan),
      m_tree(tree),
      m_rules(rules),
      m_leader(tree.size()),
      m_ring(tree.size()),
      m_members(tree.size()),
      m_next(tree.size(), none)
  {
  }

  /// Returns for each node the leader into which it is merged, or the node itself. A leader has the
  /// lowest index of its group.
  const std::vector<Index>& operator()()
  {
    const Index m = static_cast<Index>(m_tree.size());
    for (Index v = 0; v < m; ++v)
      m_leader[v] = v;
    std::vector<std::vector<Index>> children(m);
    std::vector<Index> group;
    for (Index v = 0; v < m; ++v)
      if (m_tree.parent[v] == none)
        follow(v, Ring());
      else
        children[m_tree.parent[v]].push_back(v);
    // Nodes in order: children have higher indices than all members of the ring of their parent.
    for (Index v = 0; v < m; ++v) {
      if (m_leader[v] != v)
        continue;
      group.clear();
      m_members[v].push_back(v);
      for (const Index w : m_members[v])
        group.insert(group.end(), children[w].begin(), children[w].end());
      std::sort(group.begin(), group.end());
      m_next[v] = merge_group(m_ring[v], group);
      if (m_next[v] == none && m_ring[v].age >= m_rules.age &&
          m_ring[v].radius > m_rules.lasting * m_rules.smallest * m_scan.spacing)
        m_next[v] = v;
    }
    return m_leader;
  }

  /// Returns for each leader the leader that continues its ring, or itself if a thick ring ends.
  const std::vector<Index>& next() const { return m_next; }

private:
  /// Counts the points of `v` in the band of the ring.
  std::size_t count_inside(const Ring& ring, Index v) const
  {
    const double band = m_rules.band * ring.radius + m_rules.band_offset * m_scan.spacing;
    std::size_t inside = 0;
    for (Index k = m_tree.first[v]; k < m_tree.first[v + 1]; ++k) {
      const Vec3 d = m_scan.points[m_tree.point[k]] - ring.center;
      inside += std::abs((d - d.dot(ring.along) * ring.along).norm() - ring.radius) < band;
    }
    return inside;
  }

  Index merge_group(const Ring& ring, const std::vector<Index>& group)
  {
    Index first = none;
    if (ring.radius > 0) {
      std::vector<std::size_t> inside;
      for (const Index c : group)
        inside.push_back(count_inside(ring, c));
      std::size_t most = 0; // this arc may also contain the base of a branch
      for (std::size_t k = 0; k < group.size(); ++k)
        if (inside[k] > inside[most])
          most = k;
      for (std::size_t k = 0; k < group.size(); ++k) {
        const Index c = group[k];
        const double share = k == most ? m_rules.main_share : m_rules.share;
        if (double(inside[k]) < share * double(m_tree.count(c)))
          continue;
        if (first == none)
          first = c;
        else {
          m_leader[c] = first;
          m_members[first].push_back(c);
        }
      }
    }
    for (const Index c : group)
      if (m_leader[c] == c)
        follow(c, c == first ? ring : Ring());
    return first;
  }

  /// Corrects the ring by the points of `v` and of its merged nodes, or searches for a new ring.
  void follow(Index v, const Ring& before)
  {
    Ring& ring = m_ring[v];
    Vec3 along = before.along;
    if (before.radius == 0) {
      along = direction_to(v);
      if (!(m_tree.spread[v] > 0.6 * m_rules.smallest * m_scan.spacing))
        return;
    }
    std::vector<Vec3> points;
    collect(v, points);
    for (const Index w : m_members[v])
      collect(w, points);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : points)
      mean += p;
    mean /= double(points.size());
    if (before.radius > 0) {
      ring = before;
      ring.center += along * along.dot(mean - before.center);
    }
    if (!(along.squaredNorm() > 0))
      along = Vec3::UnitZ();
    const Vec3 e1 = along.unitOrthogonal(), e2 = along.cross(e1);
    std::vector<Vec2> plane;
    for (const Vec3& p : points)
      plane.emplace_back((p - mean).dot(e1), (p - mean).dot(e2));
    const Circle c = fit_circle(plane);
    const bool is_good = c.radius > m_rules.smallest * m_scan.spacing &&
                         c.deviation < m_rules.band * c.radius &&
                         covered_sectors(plane, c.center) >= m_rules.sectors;
    if (!is_good)
      return;
    const Vec3 center = mean + c.center.x() * e1 + c.center.y() * e2;
    if (before.radius == 0)
      ring = {center, along, c.radius, 1};
    else if (c.radius < m_rules.growth * before.radius && c.radius > 0.7 * before.radius) {
      const double a = m_rules.inertia;
      ++ring.age;
      ring.radius = a * before.radius + (1 - a) * c.radius;
      const Vec3 step = center - before.center;
      ring.center = (1 - a) * center + a * ring.center;
      const double length = step.norm();
      if (length > 0)
        ring.along = (0.9 * along + 0.1 * step / length).normalized();
    }
  }

  void collect(Index v, std::vector<Vec3>& points) const
  {
    for (Index k = m_tree.first[v]; k < m_tree.first[v + 1]; ++k)
      points.push_back(m_scan.points[m_tree.point[k]]);
  }

  Vec3 direction_to(Index node) const
  {
    Index from = node;
    for (int k = 0; k < 6 && m_tree.parent[from] != none; ++k)
      from = m_leader[m_tree.parent[from]];
    const Vec3 d = m_tree.center[node] - m_tree.center[from];
    const double length = d.norm();
    return length > 0 ? Vec3(d / length) : Vec3(Vec3::Zero());
  }

  const Scan& m_scan;
  const Layer_tree& m_tree;
  Ring_arc_options m_rules;
  std::vector<Index> m_leader;
  std::vector<Ring> m_ring;
  std::vector<std::vector<Index>> m_members;
  std::vector<Index> m_next;
};

} // namespace internal

/// Merges arcs of one ring into one node.
template <class ConcurrencyTag>
void merge_ring_arcs(const Scan& scan, const Ring_arc_options& rules, Layer_tree& tree)
{
  internal::Ring_arc_merger merger(scan, tree, rules);
  const std::vector<Index>& leader = merger();
  std::vector<Index> number(tree.size(), none), parent;
  for (Index v = 0; v < tree.size(); ++v)
    if (leader[v] == v) {
      number[v] = static_cast<Index>(parent.size());
      parent.push_back(tree.parent[v] == none ? none : number[leader[tree.parent[v]]]);
    }
  for (Index& v : tree.node_of_point)
    if (v != none)
      v = number[leader[v]];
  tree.next_in_ring.assign(parent.size(), none);
  for (Index v = 0; v < tree.size(); ++v)
    if (leader[v] == v && merger.next()[v] != none)
      tree.next_in_ring[number[v]] = number[merger.next()[v]];
  tree.parent = std::move(parent);
  internal::collect_nodes<ConcurrencyTag>(scan, tree);
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_LAYERS_MERGE_RING_ARCS_H
