// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes the triangles of a mesh, or points, as a binary glTF file.

#ifndef PCS_IO_INTERNAL_GLTF_GLB_WRITER_H
#define PCS_IO_INTERNAL_GLTF_GLB_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/internal/gltf/Glb_file.h>
#include <pcs/IO/points/Write_options.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  glTF stores positions, normals and colours. Data with other properties are rejected rather than
  written without them. Polygons become fans of triangles. The origin of the positions is the center
  of the first chunk of points.
*/
class Glb_writer : public Format_writer
{
public:
  Glb_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Format_writer(path, options.faces)
  {
    for (const char* name : {"x", "y", "z"})
      m_layout.push_back(name, Scalar_type::float64);
    m_attributes.has_normals = schema.has("nx") && schema.has("ny") && schema.has("nz");
    if (m_attributes.has_normals)
      for (const char* name : {"nx", "ny", "nz"})
        m_layout.push_back(name, Scalar_type::float64);
    m_attributes.has_colors = schema.has("red") && schema.has("green") && schema.has("blue");
    m_attributes.has_alpha = m_attributes.has_colors && schema.has("alpha");
    if (m_attributes.has_colors)
      for (const char* name : {"red", "green", "blue", "alpha"})
        if (schema.has(name))
          add_color(schema, name);
    check_all_written(schema, "glTF");
  }

  void append(const Point_table& table) override
  {
    if (!m_glb && table.number_of_points() > 0)
      m_glb.emplace(m_file,
                    m_attributes,
                    center_of_box(table.number_of_points(), [&](std::size_t i, std::size_t axis) {
                      return table.points()[i][static_cast<int>(axis)];
                    }));
    Format_writer::append(table);
  }

private:
  //! colours are written as `double`; `m_color_scales` maps them to 0 to 1
  void add_color(const Point_schema& schema, const char* name)
  {
    const Scalar_type type = schema.properties[schema.find(name)].type;
    if (type != Scalar_type::uint8 && type != Scalar_type::uint16 && !is_floating_point(type))
      m_file.fail(std::string("glTF needs colours of type uint8 or uint16, or floating point "
                              "numbers from 0 to 1, '") +
                  name + "' is of type " + name_of(type));
    m_color_scales.push_back(type == Scalar_type::uint8    ? 1.0 / 255
                             : type == Scalar_type::uint16 ? 1.0 / 65535
                                                           : 1.0);
    m_layout.push_back(name, Scalar_type::float64);
  }

  void write_rows(const Row_block& block) override
  {
    const unsigned char* row = block.bytes.data();
    for (std::size_t i = 0; i < block.number_of_rows; ++i, row += m_layout.row_size, ++m_count)
      m_glb->add_vertex(vertex_of(row));
  }

  Glb_vertex vertex_of(const unsigned char* row) const
  {
    const auto next = [&] {
      const auto value = load<double>(row, m_layout.do_swap());
      row += sizeof value;
      return value;
    };
    Glb_vertex vertex;
    for (double& value : vertex.position)
      value = next();
    if (m_attributes.has_normals) {
      std::array<double, 3> normal = {next(), next(), next()};
      const double length = std::hypot(normal[0], normal[1], normal[2]);
      if (!(length > 0 && std::isfinite(length)))
        m_file.fail("the normal of point " + std::to_string(m_count) +
                    " is zero or not finite, glTF needs a direction; remove nx, ny and nz, or "
                    "write PLY");
      for (std::size_t axis = 0; axis < 3; ++axis)
        vertex.normal[axis] = static_cast<float>(normal[axis] / length);
    }
    vertex.color.fill(65535);
    for (std::size_t k = 0; k < m_color_scales.size(); ++k) {
      const double value = next() * m_color_scales[k];
      if (!(value >= 0 && value <= 1))
        m_file.fail("a colour of point " + std::to_string(m_count) +
                    " is not between 0 and 1; scale the colours, or write PLY");
      vertex.color[k] =
          k < 3 ? linear_color(value) : static_cast<std::uint16_t>(std::lround(65535 * value));
    }
    return vertex;
  }

  void finish(std::uint64_t) override
  {
    if (!m_glb || (m_faces && m_faces->number_of_faces() == 0))
      m_file.fail("glTF cannot hold a file without points or a mesh without faces; write PLY");
    std::size_t begin = 0;
    for (std::size_t face = 0; m_faces && face < m_faces->number_of_faces(); ++face) {
      const auto end = static_cast<std::size_t>(m_faces->ends[face]);
      for (std::size_t k = begin + 1; k + 1 < end; ++k)
        for (const std::size_t corner : {begin, k, k + 1})
          m_glb->add_index(m_faces->vertices[corner]);
      begin = end;
    }
    m_glb->finish();
  }

  Glb_attributes m_attributes;
  std::vector<double> m_color_scales; // one for each value of a colour
  std::optional<Glb_file> m_glb;      // begins with the first points
  std::uint64_t m_count = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_GLTF_GLB_WRITER_H
