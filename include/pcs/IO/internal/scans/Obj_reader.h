// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the vertices and faces of OBJ files.

#ifndef PCS_IO_INTERNAL_SCANS_OBJ_READER_H
#define PCS_IO_INTERNAL_SCANS_OBJ_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pcs {
namespace IO {
namespace internal {

/*
  The lines `v x y z`, `v x y z weight` and `v x y z red green blue` are points. The lines
  `f a/b/c ...` are faces, of which the index `a` of the vertex is kept on request. All other lines
  are skipped, and so is text behind `#`. The file is read twice, because OBJ files do not store the
  number of vertices.
*/
class Obj_reader : public Format_reader
{
public:
  explicit Obj_reader(const std::string& path, bool do_keep_faces = false) : m_file(path)
  {
    m_schema.format = File_format::obj;
    m_schema.properties.clear();
    std::uint64_t number_of_vertices = 0, number_of_faces = 0;
    std::size_t number_of_columns = 3;
    Input_file file(path);
    std::array<bool, other_keywords.size()> is_found{};
    for (std::string_view line; file.read_line(line);) {
      const std::string_view keyword = next_word(line);
      number_of_faces += keyword == "f" ? 1 : 0;
      for (std::size_t i = 0; i < other_keywords.size(); ++i)
        is_found[i] = is_found[i] || keyword == other_keywords[i];
      if (keyword == "v" && ++number_of_vertices == 1)
        number_of_columns = check_columns(file, without_comment(line));
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
    if (do_keep_faces) {
      keep_faces(number_of_vertices);
      warn_of_other_lines(is_found);
    }
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
      const std::string_view keyword = next_word(line);
      if (keyword != "v") {
        if (keyword == "f" && m_faces)
          read_face(line);
        continue;
      }
      parse_row(without_comment(line),
                block.bytes.data() + block.number_of_rows * m_layout.row_size);
      block.locations.push_back(m_file.line_number());
      ++block.number_of_rows;
      --m_rows_left;
    }
    while (m_rows_left == 0 && m_faces && m_file.read_line(line))
      if (next_word(line) == "f")
        read_face(line);
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(), "line " + std::to_string(location) + ": " + what);
  }

private:
  // lines that are not read
  static constexpr std::array<std::string_view, 10> other_keywords =
      {"vn", "vt", "vp", "p", "l", "g", "o", "s", "usemtl", "mtllib"};

  void warn_of_other_lines(const std::array<bool, other_keywords.size()>& is_found)
  {
    std::string names;
    for (std::size_t i = 0; i < other_keywords.size(); ++i)
      if (is_found[i])
        names += (names.empty() ? "" : ", ") + std::string(other_keywords[i]);
    if (!names.empty())
      m_schema.warnings.push_back("the lines of the mesh with " + names + " are left out");
  }

  static std::string_view without_comment(std::string_view line)
  {
    return line.substr(0, line.find('#'));
  }

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

  //! returns a line without its comment, together with the lines that continue it
  std::string whole_line(std::string_view line)
  {
    std::string text;
    for (;;) {
      line = trim(without_comment(line));
      const bool is_continued = !line.empty() && line.back() == '\\';
      text += line.substr(0, line.size() - (is_continued ? 1 : 0));
      if (!is_continued)
        return text;
      text += ' ';
      if (!m_file.read_line(line))
        m_file.fail_at_end();
    }
  }

  //! reads the words after the keyword `f`
  void read_face(std::string_view line)
  {
    const std::string text = whole_line(line);
    std::string_view rest = text;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
      m_faces->vertices.push_back(read_corner(word));
    const std::uint64_t begin = m_faces->ends.empty() ? 0 : m_faces->ends.back();
    if (m_faces->vertices.size() - begin < 3)
      m_file.fail_at_line(polygon_expected(*m_faces, m_faces->vertices.size() - begin));
    m_faces->ends.push_back(m_faces->vertices.size());
  }

  //! reads `a`, `a/b`, `a//c` or `a/b/c`; a negative index counts back from the latest vertex
  std::uint32_t read_corner(std::string_view word) const
  {
    const auto total = static_cast<std::int64_t>(m_faces->number_of_vertices);
    const auto latest = total - static_cast<std::int64_t>(m_rows_left);
    const std::size_t length = std::min(word.find('/'), word.size());
    const std::string_view others = word.substr(length);
    std::int64_t index = 0;
    if (parse_plain(without_plus(word.substr(0, length)), index) == Parse_result::ok &&
        index != 0 && index <= total && index >= -latest &&
        std::count(others.begin(), others.end(), '/') <= 2 &&
        others.find_first_not_of("0123456789-/") == std::string_view::npos)
      return static_cast<std::uint32_t>(index > 0 ? index - 1 : latest + index);
    m_file.fail_at_line("face " + std::to_string(m_faces->number_of_faces()) +
                        ": expected the index of a vertex, from 1 to " + std::to_string(total) +
                        (latest > 0 ? " or from -1 to -" + std::to_string(latest) : "") +
                        ", found " + in_quotes(word));
  }

  Input_file m_file;
  std::uint64_t m_rows_left = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_OBJ_READER_H
