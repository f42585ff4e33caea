// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a triangle mesh to a PLY, OBJ or binary glTF file.

#ifndef PCS_IO_WRITE_MESH_H
#define PCS_IO_WRITE_MESH_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/extensions.h>
#include <pcs/IO/internal/gltf/Glb_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/core/errors.h>

#include <CGAL/number_utils.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

using Mesh_points = std::vector<std::array<double, 3>>;
using Mesh_triangles = std::vector<std::array<std::size_t, 3>>;

//! returns `ply`, `obj` or `glb`; throws for other extensions
inline std::string mesh_extension(const std::string& path)
{
  refuse_gz(path);
  const std::string extension = extension_of(path);
  if (extension != "ply" && extension != "obj" && extension != "glb")
    throw IO_error(path, "the extension of a mesh must be .ply, .obj or .glb");
  return extension;
}

//! throws unless the format can hold a mesh of this size
inline void check_mesh_size(const std::string& path,
                            std::uint64_t number_of_points,
                            std::uint64_t number_of_triangles)
{
  const std::string extension = mesh_extension(path);
  constexpr std::uint64_t most_vertices = std::uint64_t(1) << 32; // indices have 32 bits
  if (extension == "ply" && number_of_points > most_vertices)
    throw IO_error(path,
                   "the mesh has " + std::to_string(number_of_points) + " vertices, PLY can hold " +
                       std::to_string(most_vertices) + "; write OBJ");
  if (extension != "glb")
    return;
  if (number_of_points > 0 && number_of_triangles == 0)
    throw IO_error(path, "glTF cannot hold vertices without triangles; write PLY or OBJ");
  if (Glb_file::size_of_file({}, number_of_points, number_of_triangles) >
      double(Glb_file::largest_size))
    throw IO_error(path,
                   "a mesh of " + std::to_string(number_of_points) + " vertices and " +
                       std::to_string(number_of_triangles) +
                       " triangles exceeds the 4 GiB of binary glTF; write PLY");
}

inline void
write_ply_mesh(Output_file& file, const Mesh_points& points, const Mesh_triangles& triangles)
{
  const bool is_index_signed = points.size() <= std::uint64_t(1) << 31;
  file.write("ply\nformat binary_little_endian 1.0\nelement vertex " +
             std::to_string(points.size()) +
             "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
             std::to_string(triangles.size()) + "\nproperty list uchar " +
             (is_index_signed ? "int" : "uint") + " vertex_indices\nend_header\n");
  std::array<unsigned char, 24> bytes{};
  for (const auto& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      store_little(bytes, 8 * axis, p[axis]);
    file.write(bytes.data(), bytes.size());
  }
  for (const auto& t : triangles) {
    bytes[0] = 3;
    for (std::size_t k = 0; k < 3; ++k)
      store_little(bytes, 1 + 4 * k, static_cast<std::uint32_t>(t[k]));
    file.write(bytes.data(), 13);
  }
}

inline void
write_obj_mesh(Output_file& file, const Mesh_points& points, const Mesh_triangles& triangles)
{
  std::string line;
  for (const auto& p : points) {
    line = "v";
    for (const double value : p) {
      line += ' ';
      append_number(line, value);
    }
    line += '\n';
    file.write(line);
  }
  for (const auto& t : triangles) {
    line = "f";
    for (const std::size_t v : t) {
      line += ' ';
      append_number(line, v + 1);
    }
    line += '\n';
    file.write(line);
  }
}

inline void
write_glb_mesh(Output_file& file, const Mesh_points& points, const Mesh_triangles& triangles)
{
  if (points.empty())
    return write_empty_glb(file);
  Glb_file glb(file, {}, center_of_box(points.size(), [&](std::size_t i, std::size_t axis) {
                 return points[i][axis];
               }));
  Glb_vertex vertex;
  for (const auto& p : points) {
    vertex.position = p;
    glb.add_vertex(vertex);
  }
  for (const auto& t : triangles)
    for (const std::size_t v : t)
      glb.add_index(static_cast<std::uint32_t>(v));
  glb.finish();
}

} // namespace internal

/*!
  \ingroup PkgPcsIORef
  \brief writes a triangle mesh in the format of the file extension, `.ply`, `.obj` or `.glb`.

  PLY is binary, with coordinates in double precision. `.glb` is binary glTF 2.0: coordinates are
  stored as `float` relative to the center of the mesh, and a node moves them to their place. The
  node also rotates them, because glTF is y-up: the point (x, y, z) is at (x, z, -y). An empty mesh
  is an empty scene. The file is written completely or not at all.

  \param path name of the file
  \param points `n` positions, of which 3 coordinates are written [L]
  \param triangles indices of points, each below `n`
  \throws pcs::IO_error when the file cannot be written or has another extension, or when the format
          cannot hold the mesh: more than 2^32 points in PLY, more than 4 GiB, or points without
          triangles, in glTF
  \throws pcs::Invalid_input when a coordinate is not finite or an index is not below `n`
  \par Complexity
  Linear; a copy of the positions is in memory.
*/
template <class Point>
void write_mesh(const std::string& path,
                const std::vector<Point>& points,
                const std::vector<std::array<std::size_t, 3>>& triangles)
{
  internal::check_mesh_size(path, points.size(), triangles.size());
  internal::Mesh_points positions;
  positions.reserve(points.size());
  for (const Point& p : points) {
    positions.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
    for (const double value : positions.back())
      if (!std::isfinite(value))
        throw Invalid_input("pcs::IO::write_mesh(): point " + std::to_string(positions.size() - 1) +
                            " is not finite");
  }
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const std::size_t v : triangles[i])
      if (v >= points.size())
        throw Invalid_input("pcs::IO::write_mesh(): triangle " + std::to_string(i) +
                            " has the vertex " + std::to_string(v) + ", the mesh has " +
                            std::to_string(points.size()) + " vertices, counted from 0");
  const std::string extension = internal::mesh_extension(path);
  internal::Output_file file(path);
  if (extension == "ply")
    internal::write_ply_mesh(file, positions, triangles);
  else if (extension == "obj")
    internal::write_obj_mesh(file, positions, triangles);
  else
    internal::write_glb_mesh(file, positions, triangles);
  file.commit();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_MESH_H
