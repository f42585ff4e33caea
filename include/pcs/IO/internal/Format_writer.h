// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interface of the writers of all formats, which write in chunks; conversion of rows to text.

#ifndef PCS_IO_INTERNAL_FORMAT_WRITER_H
#define PCS_IO_INTERNAL_FORMAT_WRITER_H

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/Row_block.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Mesh_faces.h>
#include <pcs/IO/points/Point_table.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

class Format_writer
{
public:
  //! `faces` are those of a mesh, or null; formats without faces do not use them
  explicit Format_writer(const std::string& path, std::shared_ptr<const Mesh_faces> faces = nullptr)
    : m_file(path), m_faces(std::move(faces))
  {
  }
  virtual ~Format_writer() = default;

  //! writes the points of a table that has the properties of the schema
  virtual void append(const Point_table& table)
  {
    const std::vector<std::size_t> columns = find_columns(table.schema(), m_layout);
    const std::size_t rows = rows_per_block(m_layout);
    for (std::size_t first = 0; first < table.number_of_points(); first += rows) {
      const std::size_t n = std::min(rows, table.number_of_points() - first);
      pack_rows(table, columns, first, n, m_layout, m_block);
      write_rows(m_block);
    }
  }

  //! completes the file, which contains `number_of_points` points, and renames it to its final name
  virtual void commit(std::uint64_t number_of_points)
  {
    finish(number_of_points);
    m_file.commit();
  }

protected:
  virtual void write_rows(const Row_block& block) = 0;
  virtual void finish(std::uint64_t number_of_points) = 0;

  //! writes a line per row; `do_mark_floats` distinguishes 1.0 from the integer 1
  void write_rows_as_text(const Row_block& block,
                          char separator,
                          bool do_mark_floats = false,
                          const char* keyword = "")
  {
    m_text.clear();
    const unsigned char* row = block.bytes.data();
    for (std::size_t i = 0; i < block.number_of_rows; ++i, row += m_layout.row_size) {
      m_text += keyword;
      append_row_as_text(row, separator, do_mark_floats, m_text);
      m_text.back() = '\n';
    }
    m_file.write(m_text);
  }

  //! appends the values of a row, each followed by a separator
  void append_row_as_text(const unsigned char* row,
                          char separator,
                          bool do_mark_floats,
                          std::string& text) const
  {
    for (const Field& field : m_layout.fields) {
      dispatch(field.type, [&](auto tag) {
        using T = typename decltype(tag)::type;
        const std::size_t begin = text.size();
        append_number(text, load<T>(row + field.offset, false));
        if (std::is_floating_point_v<T> && do_mark_floats &&
            text.find_first_not_of("-0123456789", begin) == std::string::npos)
          text += ".0";
      });
      text += separator;
    }
  }

  //! writes a line per face: what `begin(text, number of corners)` appends, then the corners,
  //! counted from `first`
  template <class Begin>
  void write_faces_as_text(const Begin& begin, std::uint64_t first)
  {
    if (!m_faces)
      return;
    std::uint64_t corner = 0;
    for (const std::uint64_t end : m_faces->ends) {
      m_text.clear();
      begin(m_text, end - corner);
      for (; corner < end; ++corner) {
        m_text += ' ';
        append_number(m_text, first + m_faces->vertices[corner]);
      }
      m_text += '\n';
      m_file.write(m_text);
    }
  }

  //! throws if a property or an element of the mesh is not written
  void check_all_written(const Point_schema& schema, const std::string& format) const
  {
    for (const Property_description& p : schema.properties) {
      bool is_written = false;
      for (const Field& field : m_layout.fields)
        is_written = is_written || field.name == p.name;
      if (!is_written)
        m_file.fail(format + " cannot store the property '" + p.name + "'; remove it first");
    }
    if (m_faces && !m_faces->elements.empty())
      m_file.fail(format + " cannot store further values of the PLY element '" +
                  m_faces->elements[0].name + "'; remove it first");
  }

  Output_file m_file;
  std::shared_ptr<const Mesh_faces> m_faces; // null: none
  Row_layout m_layout;

private:
  Row_block m_block;
  std::string m_text;
};

//! formats a count of a header, padded to the length of the largest count unless it is final
inline std::string count_in_header(std::uint64_t count, bool is_final)
{
  std::string text = std::to_string(count);
  constexpr std::size_t most_digits = 20;
  return is_final ? text : std::string(most_digits - text.size(), ' ') + text;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_FORMAT_WRITER_H
