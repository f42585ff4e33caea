// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of a family: on each branch the points of one scan, with correspondences in the others.

#ifndef PCS_SHAPE_SPACE_FAMILY_FAMILY_POINTS_H
#define PCS_SHAPE_SPACE_FAMILY_FAMILY_POINTS_H

#include <pcs/core/Orl_space_data.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/points/Point_instances.h>
#include <pcs/shape_space/points/tube_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace shape_space {

/// A point of a scan, and its edge of the topology.
struct Family_source
{
  std::uint32_t tree, point, edge;
};

/*!
  Points in the frames of their edges, each with corresponding points in other scans. In a tree of
  the space, a point has the mean tube coordinates of itself and its corresponding points, with the
  weights of their scans. The order of points is the same for all trees.
*/
class Family_points
{
public:
  using Point = Orl_space_data::Point;
  using Partner = Orl_space_data::Partner;

  std::size_t size() const { return m_source.size(); }
  const std::vector<std::size_t>& first() const { return m_first; }
  bool has_normals() const { return m_has_normals; }

  /// Sets the points, sorted by edge, and their corresponding points, sorted by point, in the
  /// coordinates of the space. `geometry[t]`: of the tree with scan t.
  template <class ConcurrencyTag>
  void set(const Orl_layout& layout,
           const std::vector<Orl_geometry>& geometry,
           const std::vector<Point>& points,
           const std::vector<Partner>& partners,
           bool has_normals,
           ConcurrencyTag);

  /// Calls `put(i, point, normal, k)` for all points of a tree: `i` is the index among the
  /// points on branches of the tree, `k` the index among all points. `scan_weights`: `>= 0`; empty:
  /// all equal. With `is_across`, normals are orthogonal to the edges, away from their axes.
  template <class ConcurrencyTag, class Put>
  void write(const Orl_layout& layout,
             const Orl_coordinates& x,
             const Orl_geometry& geometry,
             const std::vector<std::size_t>& offset,
             const std::vector<double>& scan_weights,
             bool is_across,
             const Put& put,
             ConcurrencyTag) const
  {
    const bool is_mixed = m_has_normals && !is_across;
    pcs::internal::for_each_index<ConcurrencyTag>(
        layout.number_of_edges(),
        [&](std::size_t e) {
          if (!(x.length[e] > 0) || m_first[e] == m_first[e + 1])
            return;
          const Edge_cone cone = edge_cone(layout, geometry, m_branch_of[e], e);
          std::size_t i = offset[e];
          for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k, ++i) {
            Tube_coordinates p = m_coordinates[k];
            Vec3 normal = is_mixed ? m_normal[k] : Vec3(is_across ? 1 : 0, 0, 0);
            for_each_weight(k, scan_weights, [&](std::size_t j, double w) {
              if (j == none)
                return;
              const Difference& d = m_partner[j];
              p.t += w * d.t;
              p.overshoot += w * d.overshoot;
              p.angle += w * d.angle;
              p.distance += w * d.distance;
              if (is_mixed)
                normal += w * m_normal_difference[j].template cast<double>();
            });
            const double t = std::min(1.0, std::max(0.0, p.t));
            const double unit = m_is_relative[e] ? cone.radius(t) : 1;
            double sine = 0, cosine = 1;
            sine_cosine(p.angle, sine, cosine);
            const double across_x = unit * p.distance * cosine, across_y = unit * p.distance * sine;
            const Vec3 local(across_x,
                             across_y,
                             cone.height(across_x, across_y, t) + unit * p.overshoot);
            if (is_mixed || is_across)
              normal = cone.frame * around(normal, sine, cosine).stableNormalized();
            put(i, Vec3(cone.from + cone.frame * local), normal, k);
          }
        },
        64);
  }

  /// Calls `f(tree, point, weight)` for a point and its corresponding points of positive weight;
  /// weights sum to 1.
  template <class F>
  void for_each_source(std::size_t k, const std::vector<double>& scan_weights, const F& f) const
  {
    for_each_weight(k, scan_weights, [&](std::size_t j, double w) {
      if (!(w > 0))
        return;
      if (j == none)
        f(std::size_t(m_source[k].tree), std::size_t(m_source[k].point), w);
      else
        f(std::size_t(m_partner[j].tree), std::size_t(m_partner[j].index), w);
    });
  }

private:
  /// The tube coordinates of a corresponding point minus the tube coordinates of the point.
  struct Difference
  {
    std::uint32_t tree, index;
    float t, overshoot, angle, distance;
  };

  static Vec3 around(const Vec3& v, double sine, double cosine)
  {
    return Vec3(cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y(), v.z());
  }

  /// Calls `f(none, w)` for the point and `f(j, w)` for corresponding point j. If the scans of
  /// all of them have weight 0, the point has weight 1.
  template <class F>
  void for_each_weight(std::size_t k, const std::vector<double>& scan_weights, const F& f) const
  {
    const std::size_t begin = m_first_partner[k], end = m_first_partner[k + 1];
    const auto of = [&](std::size_t tree) { return scan_weights.empty() ? 1 : scan_weights[tree]; };
    const double own = of(m_source[k].tree);
    double sum = own;
    for (std::size_t j = begin; j < end; ++j)
      sum += of(m_partner[j].tree);
    f(none, sum > 0 ? own / sum : 1);
    for (std::size_t j = begin; sum > 0 && j < end; ++j)
      if (const double w = of(m_partner[j].tree); w > 0)
        f(j, w / sum);
  }

  static Vec3 position_of(const Orl_space_data::Point& p)
  {
    return Vec3(p.position[0], p.position[1], p.position[2]);
  }
  static Vec3 position_of(const Orl_space_data::Partner& p)
  {
    return Vec3(p.position[0], p.position[1], p.position[2]);
  }

  void set_edge(const Orl_layout& layout,
                const std::vector<Orl_geometry>& geometry,
                const std::vector<Point>& points,
                const std::vector<Partner>& partners,
                std::size_t e);

  /// Returns the components of a normal outwards, around and along the edge.
  static Vec3 local_normal(const Edge_cone& cone, const std::array<double, 3>& v, double angle);

  /// Returns whether the radius is known and the point is near the surface, so that its distance
  /// may scale with the radius.
  static bool is_near(const Edge_cone& cone, const Vec3& position);

  std::vector<Family_source> m_source; // by edge
  std::vector<std::size_t> m_first, m_first_partner, m_branch_of;
  std::vector<char> m_is_relative;
  std::vector<Tube_coordinates> m_coordinates; // distances in radii, or in units of length
  std::vector<Vec3> m_normal;                  // outwards, around and along
  std::vector<Difference> m_partner;
  std::vector<Eigen::Vector3f> m_normal_difference; // difference of normals
  bool m_has_normals = false;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_FAMILY_POINTS_H
