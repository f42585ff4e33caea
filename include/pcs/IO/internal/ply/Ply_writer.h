// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as the vertices of a PLY file.

#ifndef PCS_IO_INTERNAL_PLY_PLY_WRITER_H
#define PCS_IO_INTERNAL_PLY_PLY_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/internal/ply/ply_header.h>
#include <pcs/IO/points/Write_options.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

class Ply_writer : public Format_writer
{
public:
  Ply_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Format_writer(path),
      m_encoding(options.ply_encoding),
      m_is_count_known(options.number_of_points.has_value())
  {
    for (const Property_description& p : schema.properties) {
      check_name(p.name);
      m_layout.push_back(p.name,
                         is_coordinate_name(p.name) && !options.keep_coordinate_types
                             ? Scalar_type::float64
                             : p.type);
    }
    if (!is_ascii())
      m_layout.is_big_endian = m_encoding == Ply_encoding::binary_big_endian;
    write_header(schema, options.number_of_points.value_or(0));
  }

private:
  bool is_ascii() const { return m_encoding == Ply_encoding::ascii; }

  void check_name(const std::string& name) const
  {
    for (const char c : name)
      if (c <= ' ' && c >= 0)
        m_file.fail("a PLY file cannot hold the property name '" + name +
                    "', which contains a blank");
  }

  void write_header(const Point_schema& schema, std::uint64_t count)
  {
    m_file.write("ply\nformat ");
    m_file.write(is_ascii()               ? "ascii"
                 : m_layout.is_big_endian ? "binary_big_endian"
                                          : "binary_little_endian");
    m_file.write(" 1.0\n");
    write_remarks("comment", schema.comments);
    write_remarks("obj_info", schema.obj_info);
    m_file.write("element vertex ");
    m_count_position = m_file.position();
    m_file.write(count_in_header(count, m_is_count_known));
    m_file.write("\n");
    for (const Field& field : m_layout.fields)
      m_file.write(std::string("property ") + ply_name(field.type) + " " + field.name + "\n");
    m_file.write("end_header\n");
  }

  void write_remarks(const std::string& keyword, const std::vector<std::string>& lines)
  {
    for (const std::string& line : lines) {
      if (line.find_first_of("\r\n") != std::string::npos)
        m_file.fail("a PLY " + keyword + " must be a single line");
      m_file.write(keyword + (line.empty() ? "" : " ") + line + "\n");
    }
  }

  void write_rows(const Row_block& block) override
  {
    if (is_ascii())
      write_rows_as_text(block, ' ');
    else
      m_file.write(block.bytes.data(), block.bytes.size());
  }

  void finish(std::uint64_t number_of_points) override
  {
    if (m_is_count_known)
      return;
    const std::string count = count_in_header(number_of_points, false);
    m_file.patch(m_count_position, count.data(), count.size());
  }

  Ply_encoding m_encoding;
  bool m_is_count_known;
  std::size_t m_count_position = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_PLY_PLY_WRITER_H
