// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the vertices of OBJ files.

#ifndef PCS_IO_INTERNAL_SCANS_OBJ_READER_H
#define PCS_IO_INTERNAL_SCANS_OBJ_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pcs {
namespace IO {
namespace internal {

/*
  The lines `v x y z`, `v x y z weight` and `v x y z red green blue` are points; all other lines are
  skipped. The file is read twice, because OBJ files do not store the number of vertices.
*/
class Obj_reader : public Format_reader
{
public:
  explicit Obj_reader(const std::string& path) : m_file(path)
  {
    m_schema.format = File_format::obj;
    m_schema.properties.clear();
    std::uint64_t number_of_vertices = 0, number_of_faces = 0;
    std::size_t number_of_columns = 3;
    Input_file file(path);
    for (std::string_view line; file.read_line(line);) {
      const std::string_view keyword = next_word(line);
      number_of_faces += keyword == "f" ? 1 : 0;
      if (keyword == "v" && ++number_of_vertices == 1)
        number_of_columns = check_columns(file, line);
    }
    if (number_of_vertices == 0)
      throw IO_error(path, "expected vertices, lines of the form: v x y z");
    for (const char* name : {"x", "y", "z"})
      add_property(name, Scalar_type::float64);
    if (number_of_columns == 4)
      add_property("weight", Scalar_type::float64);
    if (number_of_columns == 6)
      for (const char* name : {"red", "green", "blue"})
        add_property(name, Scalar_type::float64);
    warn_of_faces(number_of_faces);
    m_number_of_points = m_rows_left = number_of_vertices;
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rows, m_rows_left));
    start_block(block, n);
    std::string_view line;
    while (block.number_of_rows < n) {
      if (!m_file.read_line(line))
        m_file.fail_at_end();
      if (next_word(line) != "v")
        continue;
      parse_row(line, block.bytes.data() + block.number_of_rows * m_layout.row_size);
      block.locations.push_back(m_file.line_number());
      ++block.number_of_rows;
      --m_rows_left;
    }
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(), "line " + std::to_string(location) + ": " + what);
  }

private:
  static std::size_t check_columns(const Input_file& file, std::string_view line)
  {
    std::size_t n = 0;
    while (!next_word(line).empty())
      ++n;
    if (n != 3 && n != 4 && n != 6)
      file.fail_at_line("expected v x y z, possibly with a weight or three colours, found " +
                        std::to_string(n) + " numbers");
    return n;
  }

  void parse_row(std::string_view line, unsigned char* to) const
  {
    for (const Field& field : m_layout.fields) {
      const std::string_view word = next_word(line);
      const Parse_result result = parse_to_bytes(word, field.type, to + field.offset);
      if (result != Parse_result::ok)
        m_file.fail_at_line(number_expected(word, field.name, field.type, result));
    }
    if (!trim(line).empty())
      m_file.fail_at_line("expected " + std::to_string(m_layout.fields.size()) +
                          " numbers as in the first vertex, found also " + in_quotes(trim(line)));
  }

  Input_file m_file;
  std::uint64_t m_rows_left = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_OBJ_READER_H
