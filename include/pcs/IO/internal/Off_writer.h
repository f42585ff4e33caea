// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as the vertices of an OFF file, with the faces of a mesh.

#ifndef PCS_IO_INTERNAL_OFF_WRITER_H
#define PCS_IO_INTERNAL_OFF_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/points/Write_options.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

/*
  OFF stores only normals and colours. Data with other properties are rejected rather than written
  without them.
*/
class Off_writer : public Format_writer
{
public:
  Off_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Format_writer(path, options.faces), m_is_count_known(options.number_of_points.has_value())
  {
    const bool has_normals = schema.has("nx") && schema.has("ny") && schema.has("nz");
    const bool has_color = schema.has("red") && schema.has("green") && schema.has("blue");
    for (const char* name : {"x", "y", "z"})
      m_layout.push_back(name, Scalar_type::float64);
    if (has_normals)
      for (const char* name : {"nx", "ny", "nz"})
        m_layout.push_back(name, schema.properties[schema.find(name)].type);
    if (has_color)
      for (const char* name : {"red", "green", "blue"})
        add_color(schema, name);
    if (has_color && schema.has("alpha"))
      add_color(schema, "alpha");
    check_all_written(schema, "OFF");

    m_file.write(std::string(has_color ? "C" : "") + (has_normals ? "N" : "") + "OFF\n");
    m_count_position = m_file.position();
    m_file.write(count_in_header(options.number_of_points.value_or(0), m_is_count_known));
    m_file.write(" " + std::to_string(m_faces ? m_faces->number_of_faces() : 0) + " 0\n");
  }

private:
  void add_color(const Point_schema& schema, const char* name)
  {
    const Scalar_type type = schema.properties[schema.find(name)].type;
    if (type != Scalar_type::uint8 && !is_floating_point(type))
      m_file.fail(std::string("OFF stores colours as uint8 or floating point numbers, '") + name +
                  "' is of type " + name_of(type));
    m_layout.push_back(name, type);
  }

  void write_rows(const Row_block& block) override { write_rows_as_text(block, ' ', true); }

  void finish(std::uint64_t number_of_points) override
  {
    write_faces_as_text([](std::string& text, std::uint64_t n) { append_number(text, n); }, 0);
    if (m_is_count_known)
      return;
    const std::string count = count_in_header(number_of_points, false);
    m_file.patch(m_count_position, count.data(), count.size());
  }

  bool m_is_count_known;
  std::size_t m_count_position = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_OFF_WRITER_H
