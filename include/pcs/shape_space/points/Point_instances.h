// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of trees on a geodesic, from pairs of points in tube coordinates.

#ifndef PCS_SHAPE_SPACE_POINTS_POINT_INSTANCES_H
#define PCS_SHAPE_SPACE_POINTS_POINT_INSTANCES_H

#include <pcs/core/Orl_options.h>
#include <pcs/internal/parallel.h>
#include <pcs/shape_space/model/Point_pair.h>
#include <pcs/shape_space/points/tube_coordinates.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

/// Computes sine and cosine for |x| <= 2 pi and somewhat more, within 1e-15, without branches, so
/// that loops are vectorised.
inline void sine_cosine(double x, double& sine, double& cosine)
{
  // quadrants, then Taylor sums that are exact to the last bit but one on [-pi/4, pi/4]
  constexpr double magic = 6755399441055744.0; // 1.5 * 2^52: adding it rounds to an integer
  const double k = (x * 0.6366197723675814 + magic) - magic;
  const double r = (x - k * 1.5707963267948966) - k * 6.123233995736766e-17;
  const double z = r * r;
  const double s =
      r + r * z *
              (-1.66666666666666307295e-1 +
               z * (8.33333333332211858878e-3 +
                    z * (-1.98412698295895385996e-4 +
                         z * (2.75573136213857245213e-6 +
                              z * (-2.50507477628578072866e-8 + z * 1.58962301576546568060e-10)))));
  const double c =
      1 - 0.5 * z +
      z * z *
          (4.16666666666665929218e-2 +
           z * (-1.38888888888730564116e-3 +
                z * (2.48015872888517045348e-5 +
                     z * (-2.75573141792967388112e-7 +
                          z * (2.08757008419747316778e-9 - z * 1.13585365213876817300e-11)))));
  const double quarter = 0.25 * k;
  // k modulo 4, as 0, 1, 2, 3
  const double turns = (quarter - 0.375 + magic) - magic;
  const double q = k - 4 * turns;
  const bool is_swapped = q == 1 || q == 3;
  const double a = is_swapped ? c : s, b = is_swapped ? s : c;
  sine = q >= 2 ? -a : a;
  cosine = (q == 1 || q == 2) ? -b : b;
}

/// Precomputed pairs of points, for trees at any parameter of the path.
class Point_instances
{
public:
  /// A pair as a line in tube coordinates: value + t * change. On edges with flat sections, `angle`
  /// and `distance` are Cartesian coordinates in the section, because polar interpolation about an
  /// axis beside a blade would thicken the blade.
  struct Line
  {
    double t, dt, overshoot, d_overshoot, angle, d_angle, distance, d_distance;
  };

  Point_instances() = default;

  template <class ConcurrencyTag>
  void set(const Orl_layout& layout,
           const std::array<Orl_geometry, 2>& geometry,
           const std::array<std::vector<Vec3>, 2>& points,
           const std::array<std::vector<Vec3>, 2>& normals,
           std::vector<char> is_relative,
           std::vector<Point_pair> pairs,
           ConcurrencyTag);

  const std::vector<Point_pair>& pairs() const { return m_pairs; }
  bool has_normals() const { return m_has_normals; }
  bool is_relative(std::size_t edge) const { return m_is_relative[edge] != 0; }

  /// Finds the index in the output of the first pair of each edge that exists in `x`; the last
  /// element is the number of points.
  void find_offsets(const Orl_coordinates& x, std::vector<std::size_t>& offset) const
  {
    offset.resize(m_first.size());
    std::size_t sum = 0;
    for (std::size_t e = 0; e + 1 < m_first.size(); ++e) {
      offset[e] = sum;
      sum += x.length[e] > 0 ? m_first[e + 1] - m_first[e] : 0;
    }
    offset.back() = sum;
  }

  /// Calls `put(i, point, normal, pair)` for all points of a tree; `i` is the index in the output.
  /// Normals are those of the scans; with `is_across`, they are orthogonal to the edges.
  template <class ConcurrencyTag, class Put>
  void write(const Orl_layout& layout,
             const Orl_coordinates& x,
             const Orl_geometry& geometry,
             double lambda,
             Point_path path,
             bool is_across,
             const std::vector<std::size_t>& offset,
             const Put& put,
             ConcurrencyTag) const
  {
    const double s = std::min(1.0, std::max(0.0, lambda)); // detail is not extrapolated
    pcs::internal::for_each_index<ConcurrencyTag>(
        layout.number_of_edges(),
        [&](std::size_t e) {
          if (x.length[e] > 0 && m_first[e] < m_first[e + 1])
            write_edge(edge_cone(layout, geometry, m_branch_of[e], e),
                       {e, s, path, is_across},
                       offset[e],
                       put);
        },
        64);
  }

  /// Calls `f(i, pair)` for all points of a tree.
  template <class ConcurrencyTag, class F>
  void for_each_pair(const Orl_coordinates& x,
                     const std::vector<std::size_t>& offset,
                     const F& f,
                     ConcurrencyTag) const
  {
    pcs::internal::for_each_index<ConcurrencyTag>(
        x.length.size(),
        [&](std::size_t e) {
          if (x.length[e] > 0)
            for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k)
              f(offset[e] + k - m_first[e], m_pairs[k]);
        },
        64);
  }

private:
  /// Returns whether all points are near the surface. Otherwise their distances must not grow with
  /// the radius: scans of thin twigs are mostly noise.
  bool are_near(std::size_t e,
                const std::array<Edge_cone, 2>& cone,
                const std::array<std::vector<Vec3>, 2>& points) const;

  /// Returns whether the sections of an edge are flat, and sets their thin directions.
  bool find_flat(std::size_t e,
                 const std::array<Edge_cone, 2>& cone,
                 const std::array<std::vector<Vec3>, 2>& points);

  void set_pair(std::size_t k,
                const std::array<Edge_cone, 2>& cone,
                const std::array<std::vector<Vec3>, 2>& points,
                const std::array<std::vector<Vec3>, 2>& normals);

  /// What is written of an edge.
  struct Written_edge
  {
    std::size_t edge;
    double s; ///< parameter of the path, in [0, 1]
    Point_path path;
    bool is_across; ///< normals are orthogonal to the edge
  };

  template <class Put>
  void
  write_edge(const Edge_cone& edge, const Written_edge& what, std::size_t to, const Put& put) const
  {
    const std::size_t e = what.edge;
    const double s = what.s;
    const bool is_relative = m_is_relative[e] != 0, is_flat = m_is_flat[e] != 0;
    if (what.path == Point_path::virtual_edges) {
      for (std::size_t k = m_first[e]; k < m_first[e + 1]; ++k) {
        const double angle = is_flat ? 0 : m_lines[k].angle + s * m_lines[k].d_angle;
        put(to++,
            on_virtual_edge(edge, m_lines[k], is_relative, is_flat, s),
            normal_at(edge, what, k, std::sin(angle), std::cos(angle)),
            k);
      }
      return;
    }
    constexpr std::size_t block = 64;
    double px[block], py[block], pz[block], cosines[block], sines[block];
    for (std::size_t begin = m_first[e]; begin < m_first[e + 1]; begin += block) {
      const std::size_t n = std::min(block, m_first[e + 1] - begin);
      const Line* const line = m_lines.data() + begin;
      const double unit_0 = is_relative ? edge.from_radius : 1;
      const double unit_1 = is_relative ? edge.to_radius - edge.from_radius : 0;
      for (std::size_t i = 0; i < n; ++i) {
        const double t = line[i].t + s * line[i].dt;
        const double unit = unit_0 + t * unit_1;
        const double rho = unit * (line[i].distance + s * line[i].d_distance);
        const double angle = line[i].angle + s * line[i].d_angle;
        double sine, cosine;
        sine_cosine(is_flat ? 0 : angle, sine, cosine);
        sines[i] = sine;
        cosines[i] = cosine;
        px[i] = is_flat ? angle : rho * cosine;
        py[i] = is_flat ? rho : rho * sine;
        pz[i] = edge.height(px[i], py[i], t) + unit * (line[i].overshoot + s * line[i].d_overshoot);
      }
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 p = edge.from + edge.frame * Vec3(px[i], py[i], pz[i]);
        put(to++, p, normal_at(edge, what, begin + i, sines[i], cosines[i]), begin + i);
      }
    }
  }

  /// Returns the normal of a point, null without normals. `sine`, `cosine`: of the angle of the
  /// point.
  Vec3 normal_at(const Edge_cone& edge,
                 const Written_edge& what,
                 std::size_t k,
                 double sine,
                 double cosine) const
  {
    const double s = what.s;
    if (what.is_across) {
      if (!m_is_flat[what.edge])
        return edge.frame * Vec3(cosine, sine, 0);
      const auto& [begin, end] = m_thin_angle[what.edge];
      const double angle = (1 - s) * begin + s * end;
      return edge.frame * Vec3(std::cos(angle), std::sin(angle), 0);
    }
    if (!m_has_normals)
      return Vec3::Zero();
    const auto& ends = m_normals[k];
    const Vec3 m = (1 - s) * ends[0] + s * ends[1];
    const double length = m.norm();
    const Vec3 local = length > 0 ? Vec3(m / length) : ends[0];
    return edge.frame * Vec3(cosine * local.x() - sine * local.y(),
                             sine * local.x() + cosine * local.y(),
                             local.z());
  }

  /// Interpolates a point as published [Aiteanu 2022]: the virtual edge from the beginning of the
  /// edge to the point is rotated by slerp, and its length is linear.
  static Vec3
  on_virtual_edge(const Edge_cone& edge, const Line& line, bool is_relative, bool is_flat, double s)
  {
    const auto local = [&](double f) {
      const double t = line.t + f * line.dt;
      const double unit = is_relative ? edge.radius(t) : 1;
      const double rho = unit * (line.distance + f * line.d_distance);
      const double angle = line.angle + f * line.d_angle;
      const double x = is_flat ? angle : rho * std::cos(angle);
      const double y = is_flat ? rho : rho * std::sin(angle);
      return Vec3(x, y, edge.height(x, y, t) + unit * (line.overshoot + f * line.d_overshoot));
    };
    const Vec3 a = local(0), b = local(1);
    const double la = a.norm(), lb = b.norm();
    if (!(la > 0) || !(lb > 0))
      return edge.from + edge.frame * ((1 - s) * a + s * b);
    const Quaternion turn = Quaternion::Identity().slerp(s, shortest_turn(a / la, b / lb));
    return edge.from + edge.frame * (((1 - s) * la + s * lb) * (turn * (a / la)));
  }

  std::vector<Point_pair> m_pairs;
  std::vector<std::size_t> m_first; // pairs of each edge
  std::vector<std::uint32_t> m_branch_of;
  std::vector<char> m_is_relative, m_is_flat;
  std::vector<std::array<double, 2>>
      m_thin_angle; // of edges with flat sections: of the thin direction, in both trees [rad]
  std::vector<Line> m_lines;
  std::vector<std::array<Vec3, 2>>
      m_normals; // in the frame of the edge, rotated by the angle of the point
  bool m_has_normals = false;
};

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_POINTS_POINT_INSTANCES_H
