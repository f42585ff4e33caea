// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// As-rigid-as-possible deformation of the same meshes by CGAL, for comparison.

#ifndef PCS_BENCHMARK_QUALITY_MESH_PEER_H
#define PCS_BENCHMARK_QUALITY_MESH_PEER_H

#include <support/deformation_cases.h>
#include <support/measuring.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

namespace pcs_bench {

struct Peer_result
{
  std::vector<Vec3> points;
  std::size_t iterations = 0;
  double preprocessing = 0; ///< [s]
  double seconds = 0;       ///< preprocessing and iterations [s]
};

/// Iterates from rest until `number_of_iterations` are done or `seconds` have passed, at least
/// once.
template <CGAL::Deformation_algorithm_tag algorithm>
Peer_result
deform_mesh(const pcs_test::Deformation_case& c, std::size_t number_of_iterations, double seconds)
{
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  using Mesh = CGAL::Surface_mesh<Point>;
  using Deformation = CGAL::Surface_mesh_deformation<Mesh, CGAL::Default, CGAL::Default, algorithm>;
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Vec3& p : c.points)
    vertices.push_back(mesh.add_vertex(Point(p.x(), p.y(), p.z())));
  for (const auto& t : c.triangles)
    if (mesh.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]) == Mesh::null_face())
      throw std::runtime_error(c.name + ": the triangles are no manifold");
  Peer_result result;
  const Timer timer;
  Deformation deformation(mesh);
  deformation.insert_roi_vertices(vertices.begin(), vertices.end());
  for (const auto& handle : c.handles)
    for (const auto i : handle)
      deformation.insert_control_vertex(vertices[i]);
  if (!deformation.preprocess())
    throw std::runtime_error(c.name + ": CGAL cannot factorise");
  result.preprocessing = timer.seconds();
  for (std::size_t h = 0; h < c.handles.size(); ++h)
    for (const auto i : c.handles[h]) {
      const Vec3 p = c.transforms[h](c.points[i]);
      deformation.set_target_position(vertices[i], Point(p.x(), p.y(), p.z()));
    }
  do {
    deformation.deform(1, 0);
    ++result.iterations;
  } while (result.iterations < number_of_iterations && timer.seconds() < seconds);
  result.seconds = timer.seconds();
  for (const auto v : vertices)
    result.points.emplace_back(mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z());
  return result;
}

} // namespace pcs_bench

#endif // PCS_BENCHMARK_QUALITY_MESH_PEER_H
