// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Shapes and edits like those by which methods for the deformation of surfaces are compared: a
// twisted bar, a bent cylinder and a bent cactus of 5 to 6 thousand points.

#ifndef PCS_BENCHMARK_QUALITY_SURVEY_CASES_H
#define PCS_BENCHMARK_QUALITY_SURVEY_CASES_H

#include <support/deformation_cases.h>

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/IO/facets_in_complex_2_to_triangle_mesh.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Random.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <quality/irregular_cases.h>
#include <string>
#include <vector>

namespace pcs_bench {

/// Meshes the surface where `f` is zero, inside the unit ball, with edges of about `1.2 * size`.
/// `f` must be negative at the origin. The vertices are irregular.
inline void
mesh_surface(const std::function<double(const Vec3&)>& f, double size, Deformation_case& result)
{
  using Triangulation = CGAL::Surface_mesh_default_triangulation_3;
  using Kernel = Triangulation::Geom_traits;
  const auto value = [&](const Kernel::Point_3& p) { return f(Vec3(p.x(), p.y(), p.z())); };
  using Surface = CGAL::Implicit_surface_3<Kernel, std::function<double(Kernel::Point_3)>>;
  Triangulation triangulation;
  CGAL::Complex_2_in_triangulation_3<Triangulation> complex(triangulation);
  const Surface surface(value, Kernel::Sphere_3(CGAL::ORIGIN, 1));
  const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(30, size, 0.5 * size);
  CGAL::get_default_random() = CGAL::Random(1); // the same mesh whenever the same cases run
  CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag());
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  CGAL::facets_in_complex_2_to_triangle_mesh(complex, mesh);
  for (const auto v : mesh.vertices())
    result.points.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  for (const auto face : mesh.faces()) {
    Triangle t{};
    std::size_t k = 0;
    for (const auto v : vertices_around_face(mesh.halfedge(face), mesh))
      t[k++] = static_cast<std::uint32_t>(v);
    result.triangles.push_back(t);
  }
  result.is_closed = true;
}

/// Distance from a segment.
inline double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b)
{
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

/// The smooth minimum of two distances, rounded over about `width`.
inline double smooth_minimum(double a, double b, double width)
{
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - 0.25 * h * h * width;
}

/// Turns the points above `high` by `angle` about the y-axis at `(0, 0, pivot)`, and holds those
/// below `low`.
inline void turn_top(Deformation_case& c, double low, double high, double pivot, double angle)
{
  pcs_test::select_ends(c, low, high);
  c.transforms = {
      pcs::Similarity(),
      pcs::Similarity::about(pcs::Similarity::from_turn(Vec3(0, angle, 0)), Vec3(0, 0, pivot))};
}

inline Deformation_case survey_bar()
{
  Deformation_case c;
  c.name = "S1 bar 135";
  pcs_test::make_box(Vec3(-.5, -.5, 0), Vec3(1, 1, 4), 18, 18, 72, c);
  pcs_test::twist(c, .2, 4, 135 * pcs_test::pi / 180);
  return c;
}

/// A closed cylinder whose upper end is turned by 120 degrees about a point of its axis: the middle
/// is pressed together.
inline Deformation_case survey_cylinder()
{
  Deformation_case c;
  c.name = "S2 cylinder 120";
  const int around = 40, rings = 120;
  const double radius = 0.1, length = 2;
  const auto vertex = [&](int ring, int k) {
    return static_cast<std::uint32_t>(ring * around + (k + around) % around);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < around; ++k) {
      const double a = 2 * pcs_test::pi * (k + (ring % 2 ? .5 : 0)) / around;
      c.points.emplace_back(radius * std::cos(a),
                            radius * std::sin(a),
                            length * ring / (rings - 1));
    }
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int k = 0; k < around; ++k) {
      const int s = ring % 2;
      c.triangles.push_back({vertex(ring, k), vertex(ring, k + 1), vertex(ring + 1, k + s)});
      c.triangles.push_back(
          {vertex(ring + 1, k + s), vertex(ring, k + 1), vertex(ring + 1, k + s + 1)});
    }
  for (const int end : {0, 1}) { // caps
    const auto center = static_cast<std::uint32_t>(c.points.size());
    c.points.emplace_back(0, 0, end == 0 ? 0 : length);
    const int ring = end == 0 ? 0 : rings - 1;
    for (int k = 0; k < around; ++k)
      c.triangles.push_back({center, vertex(ring, k + 1 - end), vertex(ring, k + end)});
  }
  c.is_closed = true;
  c.length = length;
  turn_top(c, 0.05 * length, 0.95 * length, 0.5 * length, 120 * pcs_test::pi / 180);
  return c;
}

inline Deformation_case survey_cactus()
{
  Deformation_case c;
  c.name = "S3 cactus 70";
  const auto f = [](const Vec3& p) {
    const double trunk = segment_distance(p, Vec3(0, 0, -.7), Vec3(0, 0, .7)) - .15;
    const double right = std::min(segment_distance(p, Vec3(0, 0, -.1), Vec3(.38, 0, -.05)),
                                  segment_distance(p, Vec3(.38, 0, -.05), Vec3(.42, 0, .35))) -
                         .085;
    const double left = std::min(segment_distance(p, Vec3(0, 0, -.3), Vec3(-.35, .05, -.2)),
                                 segment_distance(p, Vec3(-.35, .05, -.2), Vec3(-.4, .05, .1))) -
                        .075;
    return smooth_minimum(smooth_minimum(trunk, right, .08), left, .08);
  };
  mesh_surface(f, 0.0165, c);
  for (Vec3& p : c.points)
    p.z() += .85; // the lowest point is at zero, as in the other cases
  c.length = 1.7;
  turn_top(c, .15, 1.55, .75, 70 * pcs_test::pi / 180);
  return c;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_SURVEY_CASES_H
