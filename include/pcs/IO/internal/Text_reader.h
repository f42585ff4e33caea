// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads text files with one point per line.

#ifndef PCS_IO_INTERNAL_TEXT_READER_H
#define PCS_IO_INTERNAL_TEXT_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  The first line that is neither blank nor a comment determines the separator and the number of
  columns. This line or the comment before it (as in files of CloudCompare) may be a header with the
  names of the columns. The names must include x, y and z; the first name may be empty, as in tables
  of pandas. Without a header, the first three columns are x, y and z, and the others are named
  column_4, column_5, ..., because six columns may contain normals or colours. A single integer on
  the first line is the number of points of a PTS file.
*/
class Text_reader : public Format_reader
{
public:
  explicit Text_reader(const std::string& path) : m_file(path)
  {
    m_schema.format = File_format::text;
    m_schema.properties.clear();
    if (m_file.size() == 0)
      throw IO_error(path, "the file is empty, expected a point");
    if (!next_row())
      m_file.fail_at_line("expected a line with a point or the names of the columns");
    if (m_words.size() == 1)
      read_count();
    if (is_header()) {
      use_header();
      if (m_has_row)
        next_row();
    } else if (!use_comment())
      use_default_names();
    m_comment.clear();
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
    if (!m_has_row && m_number_of_points && *m_number_of_points != m_number_of_rows)
      m_file.fail_at_line("the first line declares " + std::to_string(*m_number_of_points) +
                          " points, the file has " + std::to_string(m_number_of_rows));
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(), "line " + std::to_string(location) + ": " + what);
  }

private:
  static bool is_comment(std::string_view line)
  {
    return line[0] == '#' || line.substr(0, 2) == "//";
  }

  //! moves to the next line with content and splits it
  bool next_row()
  {
    std::string_view line;
    while (m_file.read_line(line)) {
      if (m_file.line_number() == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") // byte order mark
        line.remove_prefix(3);
      line = trim(line);
      if (line.empty())
        continue;
      if (is_comment(line)) {
        if (m_separator == '\0')
          m_comment = line;
        continue;
      }
      if (m_separator == '\0')
        choose_separator(line);
      split(line);
      return m_has_row = true;
    }
    return m_has_row = false;
  }

  void choose_separator(std::string_view line)
  {
    if (line.find(';') != std::string_view::npos)
      m_separator = ';';
    else if (line.find(',') != std::string_view::npos)
      m_separator = ',';
    else
      m_separator = ' ';
  }

  void split(std::string_view line)
  {
    m_words.clear();
    if (m_separator == ' ') {
      for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
        m_words.push_back(word);
      return;
    }
    for (;;) {
      const std::size_t end = line.find(m_separator);
      m_words.push_back(trim(line.substr(0, end)));
      if (end == std::string_view::npos)
        return;
      line.remove_prefix(end + 1);
    }
  }

  //! whether a decimal comma is used, as in "1,5 2,5": words with blanks between commas
  bool has_decimal_comma() const
  {
    if (m_separator != ',')
      return false;
    for (std::string_view word : m_words) {
      double value = 0;
      const std::string_view first = next_word(word);
      if (!trim(word).empty() && parse_number(first, value) == Parse_result::ok)
        return true;
    }
    return false;
  }

  static bool is_number(std::string_view word)
  {
    double value = 0;
    return parse_number(word, value) != Parse_result::not_a_number;
  }

  void read_count()
  {
    std::uint64_t count = 0;
    if (parse_plain(m_words[0], count) != Parse_result::ok)
      m_file.fail_at_line("expected at least three columns or the number of points, found " +
                          in_quotes(m_words[0]));
    // x, y, z, two separators and a line break, which the last line may lack
    if (count > (m_file.remaining() + 1) / 6)
      m_file.fail_at_line("the file is too small for " + std::to_string(count) + " points");
    m_number_of_points = count;
    m_separator = '\0';
    if (!next_row())
      m_words.assign({"x", "y", "z"}); // no points: the columns are unknown
  }

  bool is_header() const
  {
    for (std::size_t i = 0; i < m_words.size(); ++i)
      if (is_number(m_words[i]) || (m_words[i].empty() && (i > 0 || m_words.size() == 1)))
        return false;
    return !has_decimal_comma() && m_words[0].find(',') == std::string_view::npos;
  }

  void use_header()
  {
    for (std::string_view word : m_words) {
      if (word.size() > 2 && word.front() == '"' && word.back() == '"')
        word = word.substr(1, word.size() - 2);
      std::string name(word.empty() ? "column_1" : word);
      if (name == "X" || name == "Y" || name == "Z")
        name[0] = static_cast<char>(name[0] - 'X' + 'x');
      add_property(name, Scalar_type::float64);
    }
    const std::string twice = first_duplicate(m_schema);
    if (!twice.empty())
      m_file.fail_at_line("the column " + in_quotes(twice) + " is named twice");
    for (const char* name : {"x", "y", "z"})
      if (!m_schema.has(name))
        m_file.fail_at_line("expected numbers, or the names of the columns with x, y and z; '" +
                            std::string(name) + "' is missing");
  }

  //! uses the names in the last comment before the first row if there is one for each column,
  //! otherwise has no effect
  bool use_comment()
  {
    std::string_view names = m_comment;
    names.remove_prefix(std::min(names.size(), names.find_first_not_of("#/ \t")));
    const std::vector<std::string_view> row = m_words;
    const char separator = m_separator;
    bool is_used = false;
    if (!names.empty()) {
      choose_separator(names);
      split(names);
      const auto has = [&](char c) {
        return std::any_of(m_words.begin(), m_words.end(), [&](std::string_view word) {
          return word.size() == 1 && (word[0] == c || word[0] == c - 'a' + 'A');
        });
      };
      std::vector<std::string_view> sorted = m_words;
      std::sort(sorted.begin(), sorted.end());
      is_used = m_words.size() == row.size() && is_header() && has('x') && has('y') && has('z') &&
                std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
      if (is_used)
        use_header();
    }
    m_words = row;
    m_separator = separator;
    return is_used;
  }

  void use_default_names()
  {
    if (has_decimal_comma())
      fail_decimal_comma();
    if (m_words.size() < 3)
      m_file.fail_at_line("expected at least three columns, found " +
                          std::to_string(m_words.size()));
    for (std::size_t i = 0; i < m_words.size(); ++i)
      add_property(i < 3 ? std::string(1, static_cast<char>('x' + i))
                         : "column_" + std::to_string(i + 1),
                   Scalar_type::float64);
  }

  [[noreturn]] void fail_decimal_comma() const
  {
    m_file.fail_at_line("a decimal comma is not supported, write decimals with a point");
  }

  void parse_row(unsigned char* to) const
  {
    if (has_decimal_comma())
      fail_decimal_comma();
    if (m_words.size() != m_layout.fields.size())
      m_file.fail_at_line("expected " + std::to_string(m_layout.fields.size()) +
                          " columns, found " + std::to_string(m_words.size()));
    for (std::size_t i = 0; i < m_words.size(); ++i) {
      double value = 0;
      const Parse_result result = parse_number(m_words[i], value);
      if (result != Parse_result::ok)
        m_file.fail_at_line(
            number_expected(m_words[i], m_layout.fields[i].name, Scalar_type::float64, result));
      store(value, to + i * sizeof value, false);
    }
  }

  Input_file m_file;
  std::string m_comment;                 // the last comment before the first row
  char m_separator = '\0';               // ' ' represents any number of blanks and tabs
  std::vector<std::string_view> m_words; // words of the current line
  bool m_has_row = false;                // whether a line was read but not returned yet
  std::uint64_t m_number_of_rows = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TEXT_READER_H
