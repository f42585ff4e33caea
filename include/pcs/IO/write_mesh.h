// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes a triangle mesh to a PLY or OBJ file.

#ifndef PCS_IO_WRITE_MESH_H
#define PCS_IO_WRITE_MESH_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/numbers.h>

#include <CGAL/number_utils.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief writes a triangle mesh in the format of the file extension, `.ply` or `.obj`.

  PLY is binary, with coordinates in double precision. The file is written completely or not at
  all.

  \param path name of the file
  \param points the vertices [L]
  \param triangles the indices of three vertices each; not checked, and below 2^31 for PLY
  \throws pcs::IO_error when the file cannot be written or has another extension
  \throws pcs::Invalid_input when a coordinate is not finite
  \par Complexity
  Linear in the number of vertices and triangles.
*/
template <class Point>
void write_mesh(const std::string& path,
                const std::vector<Point>& points,
                const std::vector<std::array<std::size_t, 3>>& triangles)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  const bool is_ply = extension == ".ply" || extension == ".PLY";
  if (!is_ply && extension != ".obj" && extension != ".OBJ")
    throw IO_error(path, "the extension of a mesh must be .ply or .obj");
  std::vector<std::array<double, 3>> rows;
  rows.reserve(points.size());
  for (const Point& p : points) {
    rows.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
    for (const double value : rows.back())
      if (!std::isfinite(value))
        throw Invalid_input("pcs::IO::write_mesh(): point " + std::to_string(rows.size() - 1) +
                            " is not finite");
  }
  internal::Output_file file(path);
  std::string line;
  if (is_ply) {
    file.write("ply\nformat binary_little_endian 1.0\nelement vertex " +
               std::to_string(points.size()) +
               "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
               std::to_string(triangles.size()) +
               "\nproperty list uchar int vertex_indices\nend_header\n");
    for (const auto& row : rows)
      file.write(row.data(), sizeof(row)); // requires a little endian machine
    for (const auto& t : triangles) {
      unsigned char bytes[13] = {3};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t v = static_cast<std::int32_t>(t[k]);
        std::memcpy(bytes + 1 + 4 * k, &v, 4);
      }
      file.write(bytes, sizeof(bytes));
    }
  } else {
    for (const auto& row : rows) {
      line = "v";
      for (const double value : row) {
        line += ' ';
        internal::append_number(line, value);
      }
      line += '\n';
      file.write(line);
    }
    for (const auto& t : triangles) {
      line = "f";
      for (const std::size_t v : t) {
        line += ' ';
        internal::append_number(line, v + 1);
      }
      line += '\n';
      file.write(line);
    }
  }
  file.commit();
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_WRITE_MESH_H
