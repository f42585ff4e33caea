// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the vertices and faces of an OFF file.

#ifndef PCS_IO_INTERNAL_OFF_READER_H
#define PCS_IO_INTERNAL_OFF_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace pcs {
namespace IO {
namespace internal {

//! whether the word is an OFF keyword of any kind, supported or not
inline bool is_off_keyword(std::string_view word)
{
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"})
    if (word.substr(0, prefix.size()) == prefix)
      word.remove_prefix(prefix.size());
  return word == "OFF";
}

/*
  OFF, NOFF, COFF and CNOFF: position, normal, colour. Faces are checked, and kept on request.
  Colours are uint8 if those of the first vertex are integers, otherwise double.
*/
class Off_reader : public Format_reader
{
public:
  explicit Off_reader(const std::string& path, bool do_keep_faces = false) : m_file(path)
  {
    m_schema.format = File_format::off;
    m_schema.properties.clear();
    std::string_view line = next_line();
    std::string keyword(next_word(line));
    if (keyword == "off")
      keyword = "OFF";
    if (keyword != "OFF" && keyword != "NOFF" && keyword != "COFF" && keyword != "CNOFF")
      m_file.fail_at_line("expected 'OFF', 'NOFF', 'COFF' or 'CNOFF', found " + in_quotes(keyword) +
                          (is_off_keyword(keyword) ? ", which is not supported" : ""));
    if (trim(line).empty())
      line = next_line();
    read_counts(line);
    if (do_keep_faces)
      keep_faces(m_number_of_vertices);
    warn_of_faces(m_number_of_faces);
    for (const char* name : {"x", "y", "z"})
      add_property(name, Scalar_type::float64);
    if (keyword.find('N') != std::string::npos)
      for (const char* name : {"nx", "ny", "nz"})
        add_property(name, Scalar_type::float64);
    if (m_rows_left > 0)
      m_line = next_line();
    if (keyword[0] == 'C')
      add_colors();
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rows, m_rows_left));
    start_block(block, n);
    for (; block.number_of_rows < n; ++block.number_of_rows) {
      parse_row(block.bytes.data() + block.number_of_rows * m_layout.row_size);
      block.locations.push_back(m_file.line_number());
      if (--m_rows_left > 0)
        m_line = next_line();
    }
    if (m_rows_left == 0 && !std::exchange(m_is_end_checked, true))
      check_end();
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(), "line " + std::to_string(location) + ": " + what);
  }

private:
  //! finds the next line with content and removes its comment; false at the end of the file
  bool find_line(std::string_view& line)
  {
    while (m_file.read_line(line)) {
      line = trim(line.substr(0, line.find('#')));
      if (!line.empty())
        return true;
    }
    return false;
  }

  std::string_view next_line()
  {
    std::string_view line;
    if (!find_line(line))
      m_file.fail_at_end();
    return line;
  }

  void read_counts(std::string_view line)
  {
    std::uint64_t number_of_edges = 0; // not needed, and some programs omit it
    for (std::uint64_t* count : {&m_number_of_vertices, &m_number_of_faces, &number_of_edges}) {
      const std::string_view word = next_word(line);
      if (count == &number_of_edges && word.empty())
        break;
      if (parse_plain(word, *count) != Parse_result::ok)
        m_file.fail_at_line("expected the numbers of vertices, faces and possibly edges, found " +
                            in_quotes(word));
    }
    expect_no_more(line);
    // at least three digits with separators per vertex, one digit and a line break per face
    const std::uint64_t left = m_file.remaining() + 1;
    if (m_number_of_vertices > left / 6 ||
        m_number_of_faces > (left - 6 * m_number_of_vertices) / 2)
      m_file.fail_at_line("the file is too small for " + std::to_string(m_number_of_vertices) +
                          " vertices and " + std::to_string(m_number_of_faces) + " faces");
    m_number_of_points = m_rows_left = m_number_of_vertices;
  }

  //! adds colours; the first vertex determines whether they have an alpha and are integers
  void add_colors()
  {
    std::string_view rest = m_line;
    for (std::size_t i = 0; i < m_layout.fields.size(); ++i)
      next_word(rest);
    Scalar_type type = Scalar_type::uint8;
    std::size_t number_of_words = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      ++number_of_words;
      if (word.find_first_not_of("0123456789") != std::string_view::npos)
        type = Scalar_type::float64;
    }
    for (const char* name : {"red", "green", "blue"})
      add_property(name, type);
    if (number_of_words == 4)
      add_property("alpha", type);
  }

  void parse_row(unsigned char* to) const
  {
    std::string_view line = m_line;
    for (const Field& field : m_layout.fields) {
      const std::string_view word = next_word(line);
      const Parse_result result = parse_to_bytes(word, field.type, to + field.offset);
      if (result != Parse_result::ok)
        m_file.fail_at_line(number_expected(word, field.name, field.type, result) +
                            (field.type == Scalar_type::uint8 && is_real(word)
                                 ? "; write the colours of the first vertex with decimal points"
                                 : ""));
    }
    expect_no_more(line);
  }

  static bool is_real(std::string_view word)
  {
    double value = 0;
    return word.find('.') != std::string_view::npos &&
           parse_number(word, value) == Parse_result::ok;
  }

  void check_end()
  {
    for (std::uint64_t i = 0; i < m_number_of_faces; ++i)
      read_face(next_line());
    if (m_have_faces_colors && m_faces)
      m_faces->warnings.push_back("the colours of the faces are left out");
    std::string_view line;
    if (find_line(line))
      m_file.fail_at_line("expected the end of the file, found " + in_quotes(line));
  }

  //! reads the indices of a face, before any number of colour values
  void read_face(std::string_view line)
  {
    std::uint64_t degree = 0;
    if (parse_plain(next_word(line), degree) != Parse_result::ok)
      m_file.fail_at_line("expected the number of vertices of a face");
    if (m_faces && degree < 3)
      m_file.fail_at_line(polygon_expected(*m_faces, degree));
    for (std::uint64_t i = 0; i < degree; ++i) {
      const std::string_view word = next_word(line);
      std::uint64_t vertex = 0;
      if (parse_plain(word, vertex) != Parse_result::ok || vertex >= m_number_of_vertices)
        m_file.fail_at_line(vertex_expected(in_quotes(word), m_number_of_vertices));
      if (m_faces)
        m_faces->vertices.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (m_faces)
      m_faces->ends.push_back(m_faces->vertices.size());
    m_have_faces_colors = m_have_faces_colors || !trim(line).empty();
  }

  void expect_no_more(std::string_view line) const
  {
    if (!trim(line).empty())
      m_file.fail_at_line("expected the end of the line, found " + in_quotes(trim(line)));
  }

  Input_file m_file;
  std::string_view m_line; // the next vertex
  std::uint64_t m_number_of_vertices = 0, m_number_of_faces = 0;
  std::uint64_t m_rows_left = 0;
  bool m_have_faces_colors = false;
  bool m_is_end_checked = false;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_OFF_READER_H
