// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as the vertices of a PLY file, with the faces and other elements of a mesh.

#ifndef PCS_IO_INTERNAL_PLY_PLY_WRITER_H
#define PCS_IO_INTERNAL_PLY_PLY_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/ply/ply_header.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Write_options.h>

#include <algorithm>
#include <array>
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
    : Format_writer(path, options.faces),
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
    if (m_faces) {
      m_lists = m_faces->find("vertex");
      m_values_of_faces = m_faces->number_of_faces() > 0 ? m_faces->find("face") : nullptr;
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
    if (m_lists != nullptr)
      write_properties(*m_lists);
    if (m_faces)
      write_header_of_faces();
    m_file.write("end_header\n");
  }

  void write_header_of_faces()
  {
    std::uint64_t begin = 0, most_corners = 0;
    for (const std::uint64_t end : m_faces->ends) {
      most_corners = std::max(most_corners, end - begin);
      begin = end;
    }
    m_length_type = most_corners < 256 ? Scalar_type::uint8 : Scalar_type::uint32;
    const bool is_index_signed = m_faces->number_of_vertices <= std::uint64_t(1) << 31;
    if (m_faces->number_of_faces() > 0) {
      m_file.write("element face " + std::to_string(m_faces->number_of_faces()) +
                   "\nproperty list " + ply_name(m_length_type) +
                   (is_index_signed ? " int" : " uint") + " vertex_indices\n");
      if (m_values_of_faces != nullptr)
        write_properties(*m_values_of_faces);
    }
    for (const Element_rows& rows : m_faces->elements)
      if (is_element(rows)) {
        check_name(rows.name);
        m_file.write("element " + rows.name + " " + std::to_string(rows.number_of_rows) + "\n");
        write_properties(rows);
      }
  }

  //! whether the rows are an element other than the vertices and faces
  bool is_element(const Element_rows& rows) const
  {
    return &rows != m_lists && &rows != m_values_of_faces;
  }

  void write_properties(const Element_rows& rows)
  {
    for (const Element_property& p : rows.properties) {
      check_name(p.name);
      m_file.write(
          std::string("property ") +
          (p.count_type ? std::string("list ") + ply_name(*p.count_type) + " " : std::string()) +
          ply_name(p.type) + " " + p.name + "\n");
    }
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
    if (m_lists != nullptr)
      write_rows_with_lists(block);
    else if (is_ascii())
      write_rows_as_text(block, ' ');
    else
      m_file.write(block.bytes.data(), block.bytes.size());
  }

  void write_rows_with_lists(const Row_block& block)
  {
    const unsigned char* row = block.bytes.data();
    for (std::size_t i = 0; i < block.number_of_rows; ++i, row += m_layout.row_size) {
      m_row.clear();
      if (is_ascii())
        append_row_as_text(row, ' ', false, m_row);
      else
        m_row.append(reinterpret_cast<const char*>(row), m_layout.row_size);
      m_position_in_lists = append_values(*m_lists, m_position_in_lists);
      write_row();
    }
  }

  //! appends the values of the row that begins at byte `begin`; returns the end of the row
  std::size_t append_values(const Element_rows& rows, std::size_t begin)
  {
    return *for_each_value(rows, begin, [&](Scalar_type type, const unsigned char* bytes) {
      dispatch(type,
               [&](auto tag) { append_value(load<typename decltype(tag)::type>(bytes, false)); });
    });
  }

  template <class T>
  void append_value(T value)
  {
    if (is_ascii()) {
      append_number(m_row, value);
      m_row += ' ';
    } else {
      std::array<unsigned char, sizeof(T)> bytes;
      store(value, bytes.data(), m_layout.do_swap());
      m_row.append(reinterpret_cast<const char*>(bytes.data()), sizeof(T));
    }
  }

  void write_row()
  {
    if (is_ascii())
      m_row.back() = '\n';
    m_file.write(m_row);
  }

  void write_faces()
  {
    std::uint64_t corner = 0;
    std::size_t position = 0;
    for (const std::uint64_t end : m_faces->ends) {
      m_row.clear();
      if (m_length_type == Scalar_type::uint8)
        append_value(static_cast<std::uint8_t>(end - corner));
      else
        append_value(static_cast<std::uint32_t>(end - corner));
      for (; corner < end; ++corner)
        append_value(m_faces->vertices[corner]);
      if (m_values_of_faces != nullptr)
        position = append_values(*m_values_of_faces, position);
      write_row();
    }
    for (const Element_rows& rows : m_faces->elements) {
      position = 0;
      for (std::uint64_t i = 0; i < rows.number_of_rows && is_element(rows); ++i) {
        m_row.clear();
        position = append_values(rows, position);
        write_row();
      }
    }
  }

  void finish(std::uint64_t number_of_points) override
  {
    if (m_faces)
      write_faces();
    if (m_is_count_known)
      return;
    const std::string count = count_in_header(number_of_points, false);
    m_file.patch(m_count_position, count.data(), count.size());
  }

  Ply_encoding m_encoding;
  bool m_is_count_known;
  std::size_t m_count_position = 0;
  const Element_rows* m_lists = nullptr;           // lists of the vertices, or null
  const Element_rows* m_values_of_faces = nullptr; // values other than the corners, or null
  std::size_t m_position_in_lists = 0;             // of the next vertex [byte]
  Scalar_type m_length_type = Scalar_type::uint8;  // of the corners of a face
  std::string m_row;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_PLY_PLY_WRITER_H
