// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Bars, tubes, plates and sheets with known deformations, and the measures of a result.

#ifndef PCS_TEST_SUPPORT_DEFORMATION_CASES_H
#define PCS_TEST_SUPPORT_DEFORMATION_CASES_H

#include <pcs/core/Similarity.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcs_test {

using Vec3 = Eigen::Vector3d;
using Triangle = std::array<std::uint32_t, 3>;
constexpr double pi = 3.14159265358979323846;

/// A shape with two or more handles. `exact` and `exact_rotation` are the closed-form deformation,
/// if one exists.
struct Deformation_case
{
  std::string name;
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<std::vector<std::uint32_t>> handles;
  std::vector<pcs::Similarity> transforms;
  double length = 1;
  std::function<Vec3(const Vec3&)> exact;
  std::function<Eigen::Matrix3d(const Vec3&)> exact_rotation;
  bool is_closed = false;
};

/// Surface of a box with `nx * ny * nz` cells; shared vertices on edges, diagonals alternate.
inline void
make_box(const Vec3& low, const Vec3& size, int nx, int ny, int nz, Deformation_case& result)
{
  std::map<std::array<int, 3>, std::uint32_t> index;
  const auto vertex = [&](int i, int j, int k) {
    const auto found = index.emplace(std::array<int, 3>{i, j, k},
                                     static_cast<std::uint32_t>(result.points.size()));
    if (found.second)
      result.points.push_back(low + Vec3(size.x() * i / nx, size.y() * j / ny, size.z() * k / nz));
    return found.first->second;
  };
  const auto side =
      [&](int nu, int nv, bool is_flipped, const std::function<std::uint32_t(int, int)>& at) {
        for (int u = 0; u < nu; ++u)
          for (int v = 0; v < nv; ++v) {
            std::uint32_t a = at(u, v), b = at(u + 1, v), c = at(u + 1, v + 1), d = at(u, v + 1);
            if (is_flipped)
              std::swap(b, d);
            if ((u + v) % 2 == 0) {
              result.triangles.push_back({a, b, c});
              result.triangles.push_back({a, c, d});
            } else {
              result.triangles.push_back({a, b, d});
              result.triangles.push_back({b, c, d});
            }
          }
      };
  side(nx, ny, true, [&](int u, int v) { return vertex(u, v, 0); });
  side(nx, ny, false, [&](int u, int v) { return vertex(u, v, nz); });
  side(nx, nz, false, [&](int u, int v) { return vertex(u, 0, v); });
  side(nx, nz, true, [&](int u, int v) { return vertex(u, ny, v); });
  side(ny, nz, true, [&](int u, int v) { return vertex(0, u, v); });
  side(ny, nz, false, [&](int u, int v) { return vertex(nx, u, v); });
  result.is_closed = true;
}

inline void select_ends(Deformation_case& c, double low, double high)
{
  c.handles.assign(2, {});
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    if (c.points[i].z() <= low + 1e-9)
      c.handles[0].push_back(static_cast<std::uint32_t>(i));
    if (c.points[i].z() >= high - 1e-9)
      c.handles[1].push_back(static_cast<std::uint32_t>(i));
  }
}

/// Twist about z by `angle` between two clamps.
inline void twist(Deformation_case& c, double clamp, double length, double angle)
{
  c.length = length;
  select_ends(c, clamp, length - clamp);
  c.transforms = {pcs::Similarity(), pcs::Similarity::from_turn(Vec3(0, 0, angle))};
  const auto at = [=](const Vec3& p) {
    return angle * std::min(1.0, std::max(0.0, (p.z() - clamp) / (length - 2 * clamp)));
  };
  c.exact_rotation = [=](const Vec3& p) {
    return Eigen::AngleAxisd(at(p), Vec3::UnitZ()).toRotationMatrix();
  };
  c.exact = [=](const Vec3& p) { return Vec3(Eigen::AngleAxisd(at(p), Vec3::UnitZ()) * p); };
}

/// Bend about y by `angle` along a circular arc between two clamps.
inline void bend(Deformation_case& c, double clamp, double length, double angle)
{
  c.length = length;
  select_ends(c, clamp, length - clamp);
  const double radius = (length - 2 * clamp) / angle;
  const auto at = [=](const Vec3& p) {
    return angle * std::min(1.0, std::max(0.0, (p.z() - clamp) / (length - 2 * clamp)));
  };
  c.exact_rotation = [=](const Vec3& p) {
    return Eigen::AngleAxisd(at(p), Vec3::UnitY()).toRotationMatrix();
  };
  c.exact = [=](const Vec3& p) {
    const double t = at(p), s = clamp + t * radius;
    const Vec3 axis(radius * (1 - std::cos(t)), 0, clamp + radius * std::sin(t));
    return Vec3(axis + Eigen::AngleAxisd(t, Vec3::UnitY()) * (p - Vec3(0, 0, s)));
  };
  const Vec3 end = Vec3(0, 0, length - clamp);
  const pcs::Similarity turn =
      pcs::Similarity::about(pcs::Similarity::from_turn(Vec3(0, angle, 0)), end);
  c.transforms = {pcs::Similarity(), pcs::Similarity::from_translation(c.exact(end) - end) * turn};
}

inline Deformation_case bar_135()
{
  Deformation_case c;
  c.name = "T1 bar135";
  make_box(Vec3(-.5, -.5, 0), Vec3(1, 1, 4), 20, 20, 80, c);
  twist(c, .2, 4, 135 * pi / 180);
  return c;
}

inline Deformation_case bar_bend_120()
{
  Deformation_case c;
  c.name = "T2 barbend120";
  make_box(Vec3(-.5, -.5, 0), Vec3(1, 1, 6), 20, 20, 120, c);
  bend(c, .3, 6, 120 * pi / 180);
  return c;
}

inline Deformation_case tube_120()
{
  Deformation_case c;
  c.name = "T3 tube120";
  const int around = 48, rings = 105;
  const auto vertex = [&](int ring, int k) {
    return static_cast<std::uint32_t>(ring * around + (k + around) % around);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < around; ++k) {
      const double a = 2 * pi * (k + (ring % 2 ? .5 : 0)) / around;
      c.points.emplace_back(.5 * std::cos(a), .5 * std::sin(a), 6.0 * ring / (rings - 1));
    }
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int k = 0; k < around; ++k) {
      const int s = ring % 2;
      c.triangles.push_back({vertex(ring, k), vertex(ring, k + 1), vertex(ring + 1, k + s)});
      c.triangles.push_back(
          {vertex(ring + 1, k + s), vertex(ring, k + 1), vertex(ring + 1, k + s + 1)});
    }
  bend(c, .3, 6, 120 * pi / 180);
  return c;
}

inline Deformation_case plate_drag()
{
  Deformation_case c;
  c.name = "T4 plate";
  const int n = 100;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double x = double(i) / n, y = double(j) / n;
      c.points.emplace_back(x, y, .01 * std::sin(16 * pi * x) * std::sin(16 * pi * y));
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      if ((i + j) % 2 == 0) {
        c.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        c.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      } else {
        c.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        c.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  c.handles.assign(2, {});
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    if (c.points[i].x() <= .05 + 1e-9)
      c.handles[0].push_back(static_cast<std::uint32_t>(i));
    if (c.points[i].x() >= .95 - 1e-9)
      c.handles[1].push_back(static_cast<std::uint32_t>(i));
  }
  c.transforms = {pcs::Similarity(), pcs::Similarity::from_translation(Vec3(-.25, 0, .5))};
  return c;
}

inline Deformation_case bar_720()
{
  Deformation_case c;
  c.name = "T5 bar720";
  make_box(Vec3(-.5, -.5, 0), Vec3(1, 1, 8), 20, 20, 160, c);
  twist(c, .2, 8, 720 * pi / 180);
  return c;
}

/// Measures of a deformation over the edges of a mesh, with a free end.
struct Deformation_measures
{
  double rms_edge = 0, largest_edge = 0; ///< |l'/l - 1| [-]
  double rotation_smoothness = 0; ///< RMS angle between best-fit rotations of neighbours [deg]
  double frame_error = 0;         ///< RMS angle to the exact rotation [deg]
  double position_error = 0, largest_position_error = 0; ///< RMS and largest distance / length [-]
  double volume_ratio = 0;
};

inline double angle_degrees(const Eigen::Matrix3d& r)
{
  const Eigen::Quaterniond q(r);
  return 2 * std::atan2(q.vec().norm(), std::abs(q.w())) * 180 / pi;
}

inline double mesh_volume(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles)
{
  double volume = 0;
  for (const Triangle& t : triangles)
    volume += points[t[0]].dot(points[t[1]].cross(points[t[2]])) / 6;
  return volume;
}

inline std::vector<std::pair<std::uint32_t, std::uint32_t>>
mesh_edges(const std::vector<Triangle>& triangles)
{
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  return {edges.begin(), edges.end()};
}

inline Deformation_measures measure(const Deformation_case& c, const std::vector<Vec3>& deformed)
{
  Deformation_measures m;
  std::vector<char> is_handle(c.points.size(), 0);
  for (const auto& handle : c.handles)
    for (const auto i : handle)
      is_handle[i] = 1;
  const auto edges = mesh_edges(c.triangles);
  std::vector<Eigen::Matrix3d> covariance(c.points.size(), Eigen::Matrix3d::Zero());
  std::vector<char> has_edges(c.points.size(), 0);
  std::size_t count = 0;
  for (const auto& e : edges) {
    const Vec3 before = c.points[e.second] - c.points[e.first],
               after = deformed[e.second] - deformed[e.first];
    covariance[e.first] += after * before.transpose();
    covariance[e.second] += after * before.transpose();
    has_edges[e.first] = has_edges[e.second] = 1;
    if (is_handle[e.first] && is_handle[e.second])
      continue;
    const double distortion = std::abs(after.norm() / before.norm() - 1);
    m.rms_edge += distortion * distortion;
    m.largest_edge = std::max(m.largest_edge, distortion);
    ++count;
  }
  m.rms_edge = std::sqrt(m.rms_edge / double(count));
  std::vector<Eigen::Matrix3d> fit(c.points.size(), Eigen::Matrix3d::Identity());
  for (std::size_t i = 0; i < fit.size(); ++i) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance[i],
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0)
      u.col(2) *= -1;
    fit[i] = u * svd.matrixV().transpose();
  }
  count = 0;
  for (const auto& e : edges) {
    if (is_handle[e.first] && is_handle[e.second])
      continue;
    const double a = angle_degrees(fit[e.first].transpose() * fit[e.second]);
    m.rotation_smoothness += a * a;
    ++count;
  }
  m.rotation_smoothness = std::sqrt(m.rotation_smoothness / double(count));
  if (c.exact) {
    count = 0;
    for (std::size_t i = 0; i < fit.size(); ++i) {
      if (is_handle[i] || !has_edges[i])
        continue;
      const double a = angle_degrees(c.exact_rotation(c.points[i]).transpose() * fit[i]);
      m.frame_error += a * a;
      const double d = (deformed[i] - c.exact(c.points[i])).norm() / c.length;
      m.position_error += d * d;
      m.largest_position_error = std::max(m.largest_position_error, d);
      ++count;
    }
    m.frame_error = std::sqrt(m.frame_error / double(count));
    m.position_error = std::sqrt(m.position_error / double(count));
  }
  if (c.is_closed)
    m.volume_ratio = mesh_volume(deformed, c.triangles) / mesh_volume(c.points, c.triangles);
  return m;
}

} // namespace pcs_test

#endif // PCS_TEST_SUPPORT_DEFORMATION_CASES_H
