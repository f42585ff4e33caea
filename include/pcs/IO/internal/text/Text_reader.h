// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads text files with one point per line.

#ifndef PCS_IO_INTERNAL_TEXT_TEXT_READER_H
#define PCS_IO_INTERNAL_TEXT_TEXT_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/text/Table_head.h>
#include <pcs/IO/internal/text/table_words.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  The head determines the separator and the columns. The coordinates are the columns with the names
  x, y and z or with names such as Easting, Northing and Height, in any order. Columns such as Nx,
  Ny and Nz are named nx, ny and nz, if there are all three. Without names, the first three columns
  are x, y and z, and the others are named column_4, column_5, ..., because six columns may contain
  normals or colours. "TRUE" and "FALSE" are 1 and 0, except in coordinates. Other columns with text
  are left out with a warning; their missing values are NaN. A first column without a name that
  counts the rows is refused, because it would be read as x.
*/
class Text_reader : public Format_reader
{
public:
  explicit Text_reader(const std::string& path) : m_head(path), m_file(path)
  {
    m_schema.format = File_format::text;
    m_schema.properties.clear();
    m_number_of_points = m_head.number_of_points;
    for (const Table_head::Column& column : m_head.columns)
      if (column.text_line == 0 || is_coordinate_name(column.name)) {
        m_is_read.push_back(true);
        add_property(column.name, Scalar_type::float64);
      } else {
        m_is_read.push_back(false);
        m_schema.warnings.push_back("column " + in_quotes(column.name) + " contains text (" +
                                    in_quotes(column.text) + " in line " +
                                    std::to_string(column.text_line) + ") and is left out");
      }
    if (m_head.has_decimal_commas)
      m_schema.warnings.push_back("commas in numbers are read as decimal points");
    m_may_count_rows = !m_head.has_names && m_head.columns.size() > 3;
    if (m_head.first_row > 0)
      while (m_file.line_number() < m_head.first_row)
        next_row();
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    start_block(block, max_rows);
    while (block.number_of_rows < max_rows && m_has_row) {
      parse_row(block.bytes.data() + block.number_of_rows * m_layout.row_size);
      block.locations.push_back(m_file.line_number());
      ++block.number_of_rows;
      ++m_number_of_rows;
      next_row();
    }
    if (m_has_row)
      return;
    if (m_number_of_points && *m_number_of_points != m_number_of_rows)
      m_file.fail_at_line("the head of the file declares " + std::to_string(*m_number_of_points) +
                          " points, the file has " + std::to_string(m_number_of_rows));
    if (m_may_count_rows && m_number_of_rows >= fewest_counted_rows)
      fail_row_numbers();
  }

  //! throws the error of a coordinate that is not finite, with a command that removes such points
  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    std::string digits;
    for (std::size_t i = 0; i < m_head.columns.size(); ++i)
      if (is_coordinate_name(m_head.columns[i].name))
        digits += (digits.empty() ? "$" : " && $") + std::to_string(i + 1) + " ~ /[0-9]/";
    throw IO_error(m_file.path(),
                   "line " + std::to_string(location) + ": " + what +
                       "; to remove points without coordinates: awk " + awk_separator() + "'NR < " +
                       std::to_string(m_head.first_row) + " || (" + digits + ")' " +
                       m_file.shell_name() + " > NEW_FILE");
  }

private:
  static constexpr std::uint64_t fewest_counted_rows = 10; // fewer may be coordinates by chance

  //! moves to the next line with content and splits it
  bool next_row()
  {
    while (m_file.read_line(m_line)) {
      if (m_file.line_number() == 1)
        m_line = without_byte_order_mark(m_line);
      const std::string_view line = trim(m_line);
      if (line.empty() || is_table_comment(line))
        continue;
      split_table_line(trim_table_line(m_line, m_head.separator), m_head.separator, m_words);
      return m_has_row = true;
    }
    return m_has_row = false;
  }

  //! corrects the number of words in a table whose separators are tabs
  void split_again()
  {
    const std::size_t expected = m_head.columns.size();
    if (m_head.separator != '\t' || m_words.size() == expected)
      return;
    if (m_words.size() == expected + 1 && m_words.back().empty())
      m_words.pop_back();
    else
      split_table_line(m_line, ' ', m_words); // blanks in other lines than the first
  }

  void parse_row(unsigned char* to)
  {
    split_again();
    if (m_words.size() != m_head.columns.size())
      m_file.fail_at_line("expected " + std::to_string(m_head.columns.size()) + " columns, found " +
                          std::to_string(m_words.size()));
    for (std::size_t i = 0; i < m_words.size(); ++i) {
      if (!m_is_read[i])
        continue;
      double value = 0;
      if (parse_number(m_words[i], value) != Parse_result::ok)
        value = parse_unusual_number(i);
      if (i == 0 && m_may_count_rows)
        check_count(value);
      store(value, to, false);
      to += sizeof value;
    }
  }

  double parse_unusual_number(std::size_t i) const
  {
    double value = 0;
    if (!is_coordinate_name(m_head.columns[i].name) && parse_truth_value(m_words[i], value))
      return value;
    const Parse_result result = parse_table_number(m_words[i], m_head.is_comma_decimal(), value);
    if (result != Parse_result::ok)
      fail_word(i, result);
    if (m_words[i].find(',') != std::string_view::npos)
      for (const std::string_view word : m_words)
        if (word.find('.') != std::string_view::npos && is_table_number(word, false))
          m_file.fail_at_line("decimal commas and decimal points in one line, " +
                              in_quotes(m_words[i]) + " and " + in_quotes(word) +
                              "; write all decimals with a point");
    return value;
  }

  [[noreturn]] void fail_word(std::size_t i, Parse_result result) const
  {
    const std::string& name = m_head.columns[i].name;
    const std::string_view word = m_words[i];
    std::string text =
        "expected a number of type float64 for " + in_quotes(name) + ", found " + in_quotes(word);
    if (result == Parse_result::out_of_range)
      text += ", which is out of range";
    else if (word.find(',') != std::string_view::npos)
      text += m_head.separator == ','
                  ? "; a decimal comma is possible if semicolons, tabs or blanks separate columns"
                  : "; a comma may only separate decimals, not thousands";
    else if (!is_coordinate_name(name))
      text += "; to remove the column: awk " + awk_separator() + "'{$" + std::to_string(i + 1) +
              "=\"\"}1' " + m_file.shell_name() + " > NEW_FILE";
    else if (!m_head.has_names)
      text += "; unless the first three columns are x, y and z, add a first line with the names "
              "of all columns";
    m_file.fail_at_line(text);
  }

  std::string awk_separator() const
  {
    const char separator = m_head.separator;
    if (separator == ' ')
      return {};
    const std::string text = separator == '\t' ? "\\t" : std::string(1, separator);
    return "-F'" + text + "' -v OFS='" + text + "' ";
  }

  //! compares the first column with the number of the row, counted from 0 or 1
  void check_count(double value)
  {
    if (m_number_of_rows == 0)
      m_first_count = value;
    m_may_count_rows = (m_first_count == 0 || m_first_count == 1) &&
                       value == m_first_count + static_cast<double>(m_number_of_rows);
  }

  [[noreturn]] void fail_row_numbers() const
  {
    const char first = m_first_count == 0 ? '0' : '1';
    std::string others;
    for (std::size_t i = 4; i < m_head.columns.size(); ++i)
      others += " c" + std::to_string(i);
    throw IO_error(m_file.path(),
                   "line " + std::to_string(m_head.first_row) + ": the first column counts the " +
                       "rows from " + first + ", x was expected; add a first line with the names " +
                       "of the columns: sed '1i # id x y z" + others + "' " + m_file.shell_name() +
                       " > NEW_FILE, or '# "
                       "x y z c3" +
                       others + "' if the count is x");
  }

  Table_head m_head;
  Input_file m_file;
  std::vector<bool> m_is_read; // one per column
  std::string_view m_line;
  Table_words m_words;    // words of the current line
  bool m_has_row = false; // whether a line was read but not returned yet
  bool m_may_count_rows = false;
  double m_first_count = 0;
  std::uint64_t m_number_of_rows = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TEXT_TEXT_READER_H
