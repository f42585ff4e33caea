// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Detects the separator, the columns and the first row of a table in a text file.

#ifndef PCS_IO_INTERNAL_TEXT_TABLE_HEAD_H
#define PCS_IO_INTERNAL_TEXT_TABLE_HEAD_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/text/coordinate_columns.h>
#include <pcs/IO/internal/text/table_words.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

inline bool is_table_comment(std::string_view line)
{
  return line[0] == '#' || line[0] == '%' || line.substr(0, 2) == "//";
}

inline std::string_view without_byte_order_mark(std::string_view line)
{
  return line.substr(0, 3) == "\xEF\xBB\xBF" ? line.substr(3) : line;
}

/*!
  Reads the head of a table and its first rows. The head may contain the number of points, lines of
  text, a line with the names of the columns and a line with their units. The names may also be in
  the last comment before the first row (as in files of CloudCompare). Rows may have one word more
  than there are names, because R writes row names without a column name.
*/
class Table_head
{
public:
  struct Column
  {
    std::string name;
    std::string text;            // first word that is not a number; the column is then left out
    std::uint64_t text_line = 0; // line of this word, 0: none
  };

  explicit Table_head(const std::string& path) : m_file(path)
  {
    if (m_file.is_at_end())
      throw IO_error(path, "the file is empty, expected a point");
    if (!find_first_row()) {
      if (!m_names.empty())
        finish_names(m_names.size());
      else if (number_of_points)
        m_names = {"x", "y", "z"}; // no points: the columns are unknown
      else if (!m_error.empty())
        throw IO_error(path, m_error);
      else
        m_file.fail_at_line("expected a line with a point or the names of the columns");
    } else {
      first_row = m_file.line_number();
      name_columns();
    }
    for (const std::string& name : m_names)
      columns.push_back({name, {}, 0});
    if (first_row > 0)
      inspect_rows();
  }

  std::vector<Column> columns;
  char separator = ' ';
  bool has_names = false;
  bool has_decimal_commas = false;
  std::uint64_t first_row = 0; // line number, 0: no rows
  std::optional<std::uint64_t> number_of_points;

  bool is_comma_decimal() const { return separator != ','; }

private:
  static constexpr std::uint64_t most_inspected_rows = 1000;
  static constexpr std::uint64_t longest_head = 100; // lines of text before the first row

  //! moves to the next line with content that is not a comment
  bool next_line(bool do_keep_comment)
  {
    while (m_file.read_line(m_line)) {
      if (m_file.line_number() == 1)
        m_line = without_byte_order_mark(m_line);
      const std::string_view line = trim(m_line);
      if (line.empty())
        continue;
      if (!is_table_comment(line))
        return true;
      if (do_keep_comment)
        m_comment = line;
    }
    return false;
  }

  void split(std::string_view line, char by)
  {
    separator = by;
    split_table_line(trim_table_line(line, by), by, m_words);
  }

  bool find_first_row()
  {
    for (std::uint64_t n = 0; next_line(true); ++n) {
      split(m_line, find_separator(m_line));
      if (is_row())
        return true;
      if (m_words.size() == 1 && is_table_number(m_words[0], false))
        read_count();
      else if (!m_names.empty())
        check_units();
      else if (n < longest_head)
        read_names();
      else
        m_file.fail_at_line("there are no numbers in the first " + std::to_string(n) + " lines");
    }
    return false;
  }

  //! whether the line has at least two words, and begins with a number or contains three numbers
  bool is_row() const
  {
    const auto is_number = [&](std::string_view word) {
      return is_table_number(word, is_comma_decimal());
    };
    return m_words.size() > 1 &&
           (is_number(m_words[0]) || std::count_if(m_words.begin(), m_words.end(), is_number) >= 3);
  }

  void read_count()
  {
    std::uint64_t count = 0;
    if (number_of_points || parse_plain(m_words[0], count) != Parse_result::ok)
      m_file.fail_at_line("expected at least three columns or the number of points, found " +
                          in_quotes(m_words[0]));
    // a row has at least 6 bytes: three digits, two separators, and a line break except at the end
    if (count > (m_file.remaining() + 1) / 6)
      m_file.fail_at_line("the file is too small for " + std::to_string(count) + " points");
    number_of_points = count;
  }

  //! takes the names of the columns from the line if it contains names of the coordinates
  void read_names()
  {
    std::vector<std::string> names;
    for (const std::string_view word : m_words)
      names.emplace_back(without_quotes(word));
    const Coordinate_columns found = find_coordinate_columns(names);
    if (!found.error.empty()) {
      if (m_error.empty())
        m_error = "line " + std::to_string(m_file.line_number()) + ": " + found.error;
      return;
    }
    m_names = std::move(names);
    m_names_line = m_file.line_number();
  }

  void check_units() const
  {
    const std::array<std::size_t, 3> coordinates = find_coordinate_columns(m_names).index;
    if (m_file.line_number() > m_names_line + 3 || !are_units(m_words, coordinates))
      m_file.fail_at_line("expected the numbers of a point, or units such as 'm', found " +
                          in_quotes(trim(m_line)));
  }

  void name_columns()
  {
    const std::size_t n = m_words.size();
    if (m_names.empty() && !m_error.empty())
      throw IO_error(m_file.path(), m_error);
    if (m_names.empty())
      use_comment();
    if (!m_names.empty()) {
      if (n == m_names.size() + 1)
        m_names.insert(m_words.back().empty() ? m_names.end() : m_names.begin(), std::string());
      else if (n != m_names.size())
        fail_number_of_columns();
      finish_names(n);
      return;
    }
    if (n < 3)
      m_file.fail_at_line("expected at least three columns, found " + std::to_string(n));
    for (std::size_t i = 0; i < n; ++i)
      m_names.push_back(i < 3 ? std::string(1, static_cast<char>('x' + i)) : default_name(i));
  }

  [[noreturn]] void fail_number_of_columns() const
  {
    const std::size_t n = m_words.size(), expected = m_names.size();
    m_file.fail_at_line("expected " + std::to_string(expected) + " columns as in line " +
                        std::to_string(m_names_line) + ", found " + std::to_string(n) +
                        (separator == ',' && n == 2 * expected
                             ? "; with decimal commas, separate columns by semicolons or tabs"
                             : ""));
  }

  static std::string default_name(std::size_t i) { return "column_" + std::to_string(i + 1); }

  //! completes the names of `n` columns, and names the coordinates x, y, z and a normal nx, ny, nz
  void finish_names(std::size_t n)
  {
    has_names = true;
    const std::array<std::size_t, 3> coordinates = find_coordinate_columns(m_names).index;
    for (std::size_t i = 0; i < n; ++i)
      if (m_names[i].empty())
        m_names[i] = default_name(i);
    for (std::size_t axis = 0; axis < 3; ++axis)
      m_names[coordinates[axis]] = std::string(1, static_cast<char>('x' + axis));
    const std::vector<std::size_t> normal = find_normal_columns(m_names);
    for (std::size_t axis = 0; axis < normal.size(); ++axis)
      m_names[normal[axis]] = std::string("n") + static_cast<char>('x' + axis);
    for (std::size_t i = 0; i < n; ++i)
      if (std::find(m_names.begin(),
                    m_names.begin() + static_cast<std::ptrdiff_t>(i),
                    m_names[i]) != m_names.begin() + static_cast<std::ptrdiff_t>(i))
        throw IO_error(m_file.path(),
                       "line " + std::to_string(m_names_line) + ": the column " +
                           in_quotes(m_names[i]) + " is named twice");
  }

  //! takes the names from the comment before the first row if it has one for each column
  void use_comment()
  {
    std::string_view line = m_comment;
    line.remove_prefix(std::min(line.size(), line.find_first_not_of("#%/ \t")));
    Table_words words;
    split_table_line(line, find_separator(line), words);
    std::vector<std::string> names;
    for (const std::string_view word : words) {
      names.emplace_back(without_quotes(word));
      if (names.back().empty() || is_table_number(word, false) ||
          std::find(names.begin(), names.end() - 1, names.back()) != names.end() - 1)
        return;
    }
    if (names.size() == m_words.size() && find_coordinate_columns(names).error.empty())
      m_names = std::move(names);
  }

  //! detects text columns and decimal commas in the first rows
  void inspect_rows()
  {
    std::uint64_t n = 0;
    do {
      split(m_line, separator);
      for (std::size_t i = 0; i < std::min(columns.size(), m_words.size()); ++i)
        inspect(m_words[i], columns[i]);
    } while (++n < most_inspected_rows && next_line(false));
  }

  void inspect(std::string_view word, Column& column)
  {
    double value = 0;
    if (parse_number(word, value) != Parse_result::not_a_number ||
        (!is_coordinate_name(column.name) && parse_truth_value(word, value)))
      return;
    if (is_table_number(word, is_comma_decimal()) || word.empty()) {
      has_decimal_commas = has_decimal_commas || has_decimal_comma(word);
    } else if (column.text_line == 0) {
      column.text = word;
      column.text_line = m_file.line_number();
    }
  }

  Input_file m_file;
  std::string_view m_line;
  Table_words m_words;
  std::string m_comment; // the last comment before the first row
  std::vector<std::string> m_names;
  std::uint64_t m_names_line = 0;
  std::string m_error; // reason why the first line of text has no column names
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TEXT_TABLE_HEAD_H
