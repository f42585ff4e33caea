// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads PTX files: scans in rows and columns, each with the pose of its scanner.

#ifndef PCS_IO_INTERNAL_SCANS_PTX_READER_H
#define PCS_IO_INTERNAL_SCANS_PTX_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pcs {
namespace IO {
namespace internal {

/*
  Every scan has a header of ten lines: numbers of columns and rows, position and axes of the
  scanner, and a matrix M of four lines. The position of a point is (x y z 1) M. The properties are
  x, y, z, intensity, and red, green, blue if there are seven columns; `scan` is the index of the
  scan. Points 0 0 0 are pixels without return and are left out.
*/
class Ptx_reader : public Format_reader
{
public:
  explicit Ptx_reader(const std::string& path) : m_file(path)
  {
    m_schema.format = File_format::ptx;
    m_schema.properties.clear();
    if (!next_line())
      m_file.fail_at_end();
    read_header();
    while (m_points_left == 0 && next_line())
      read_header();
    if (m_points_left > 0 && !next_line())
      m_file.fail_at_end();
    const std::size_t n = number_of_words();
    if (m_points_left > 0 && n != 3 && n != 4 && n != 7)
      m_file.fail_at_line("expected x, y, z, an intensity and possibly three colours, found " +
                          std::to_string(n) + " columns");
    for (const char* name : {"x", "y", "z"})
      add_property(name, Scalar_type::float64);
    if (n >= 4)
      add_property("intensity", Scalar_type::float64);
    if (n == 7)
      for (const char* name : {"red", "green", "blue"})
        add_property(name, Scalar_type::uint8);
    m_number_of_columns = m_layout.fields.size();
    add_property("scan", Scalar_type::int32);
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    start_block(block, max_rows);
    while (block.number_of_rows < max_rows && m_points_left > 0) {
      unsigned char* row = block.bytes.data() + block.number_of_rows * m_layout.row_size;
      if (parse_row(row)) {
        block.locations.push_back(m_file.line_number());
        ++block.number_of_rows;
      }
      --m_points_left;
      while (m_points_left == 0 && next_line()) {
        read_header();
        ++m_scan;
      }
      if (m_points_left > 0 && !next_line())
        m_file.fail_at_end();
    }
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(), "line " + std::to_string(location) + ": " + what);
  }

private:
  //! moves to the next line with content
  bool next_line()
  {
    while (m_file.read_line(m_line)) {
      m_line = trim(m_line);
      if (!m_line.empty())
        return true;
    }
    m_line = {};
    return false;
  }

  std::size_t number_of_words() const
  {
    std::string_view line = m_line;
    std::size_t n = 0;
    while (!next_word(line).empty())
      ++n;
    return n;
  }

  std::uint64_t count(const char* what) const
  {
    std::uint64_t value = 0;
    if (parse_plain(m_line, value) != Parse_result::ok)
      m_file.fail_at_line(std::string("expected the number of ") + what + " of a scan, found " +
                          in_quotes(m_line));
    return value;
  }

  //! reads `N` numbers from the current line
  template <std::size_t N>
  std::array<double, N> numbers(const char* what) const
  {
    std::array<double, N> values{};
    std::string_view line = m_line;
    for (double& value : values)
      if (parse_number(next_word(line), value) != Parse_result::ok || !std::isfinite(value))
        m_file.fail_at_line(std::string("expected ") + std::to_string(N) + " numbers, " + what +
                            ", found " + in_quotes(m_line));
    if (!trim(line).empty())
      m_file.fail_at_line("expected the end of the line, found " + in_quotes(trim(line)));
    return values;
  }

  void next_header_line()
  {
    if (!next_line())
      m_file.fail_at_end();
  }

  //! reads a header whose first line is the current line
  void read_header()
  {
    const std::uint64_t columns = count("columns");
    next_header_line();
    const std::uint64_t rows = count("rows");
    for (const char* what : {"the position of the scanner",
                             "an axis of the scanner",
                             "an axis of the scanner",
                             "an axis of the scanner"}) {
      next_header_line();
      numbers<3>(what);
    }
    for (std::array<double, 4>& row : m_matrix) {
      next_header_line();
      row = numbers<4>("a row of the matrix");
    }
    for (std::size_t i = 0; i < 4; ++i)
      if (m_matrix[i][3] != (i < 3 ? 0 : 1))
        m_file.fail_at_line("expected a matrix with the last column 0 0 0 1 and the translation in "
                            "its last line");
    // three digits, two separators and a line break, which the last line may lack
    const std::uint64_t most = (m_file.remaining() + 1) / 6;
    if (columns > most || (columns > 0 && rows > most / columns))
      m_file.fail_at_line("the file is too small for a scan of " + std::to_string(columns) +
                          " columns and " + std::to_string(rows) +
                          " rows; it may be incomplete, copy it again");
    m_points_left = columns * rows;
  }

  //! parses the current line; returns whether it is a point with a return
  bool parse_row(unsigned char* to) const
  {
    std::array<double, 3> p{};
    std::string_view line = m_line;
    for (std::size_t i = 0; i < m_number_of_columns; ++i) {
      const Field& field = m_layout.fields[i];
      const std::string_view word = next_word(line);
      const Parse_result result =
          i < 3 ? parse_number(word, p[i]) : parse_to_bytes(word, field.type, to + field.offset);
      if (result != Parse_result::ok)
        m_file.fail_at_line(number_expected(word, field.name, field.type, result));
    }
    if (!trim(line).empty())
      m_file.fail_at_line("expected " + std::to_string(m_number_of_columns) + " columns, found " +
                          std::to_string(number_of_words()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double value = p[0] * m_matrix[0][axis] + p[1] * m_matrix[1][axis] +
                           p[2] * m_matrix[2][axis] + m_matrix[3][axis];
      store(value, to + m_layout.fields[axis].offset, false);
    }
    store(m_scan, to + m_layout.fields.back().offset, false);
    return p[0] != 0 || p[1] != 0 || p[2] != 0;
  }

  Input_file m_file;
  std::string_view m_line; // the next point
  std::array<std::array<double, 4>, 4> m_matrix{};
  std::size_t m_number_of_columns = 0;
  std::uint64_t m_points_left = 0; // of the current scan
  std::int32_t m_scan = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_PTX_READER_H
