// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Words of a line of a table: separators, quotation marks, missing values, decimal commas.

#ifndef PCS_IO_INTERNAL_TEXT_TABLE_WORDS_H
#define PCS_IO_INTERNAL_TEXT_TABLE_WORDS_H

#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

using Table_words = std::vector<std::string_view>;

inline std::string to_lower(std::string_view word)
{
  std::string text(word);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return text;
}

//! removes blanks at both ends and the quotation marks around a word
inline std::string_view without_quotes(std::string_view word)
{
  word = trim(word);
  if (word.size() >= 2 && word.front() == '"' && word.back() == '"')
    word = trim(word.substr(1, word.size() - 2));
  return word;
}

//! whether the word means a missing value: it is empty, or for example `NA`
inline bool is_missing(std::string_view word)
{
  word = without_quotes(word);
  if (word.empty())
    return true;
  if (word.size() > 4)
    return false;
  constexpr std::array<std::string_view, 7> names =
      {"na", "n/a", "#n/a", "nan", "null", "none", "-"};
  return std::find(names.begin(), names.end(), to_lower(word)) != names.end();
}

//! whether the word has one comma, between digits, and no point
inline bool has_decimal_comma(std::string_view word)
{
  const std::size_t comma = word.find(',');
  const auto is_digit = [&](std::size_t i) {
    return i < word.size() && word[i] >= '0' && word[i] <= '9';
  };
  return comma != std::string_view::npos && comma > 0 && is_digit(comma - 1) &&
         is_digit(comma + 1) && word.find_first_of(".,", comma + 1) == std::string_view::npos &&
         word.find('.') == std::string_view::npos;
}

/*!
  Converts a word to a number. Missing values become NaN. Numbers may be quoted, and may have a
  decimal comma if `is_comma_decimal`.
*/
inline Parse_result parse_table_number(std::string_view word, bool is_comma_decimal, double& value)
{
  const Parse_result result = parse_number(word, value);
  if (result != Parse_result::not_a_number)
    return result;
  if (is_missing(word)) {
    value = std::numeric_limits<double>::quiet_NaN();
    return Parse_result::ok;
  }
  word = without_quotes(word);
  if (!is_comma_decimal || !has_decimal_comma(word))
    return parse_number(word, value);
  std::string with_point(word);
  with_point[with_point.find(',')] = '.';
  return parse_number(std::string_view(with_point), value);
}

inline bool is_table_number(std::string_view word, bool is_comma_decimal)
{
  double value = 0;
  return !without_quotes(word).empty() &&
         parse_table_number(word, is_comma_decimal, value) != Parse_result::not_a_number;
}

//! converts "true" and "false", as R and Python write labels, to 1 and 0; `false` for other words
inline bool parse_truth_value(std::string_view word, double& value)
{
  word = without_quotes(word);
  for (const char* name : {"TRUE", "True", "true"})
    if (word == name)
      return value = 1, true;
  for (const char* name : {"FALSE", "False", "false"})
    if (word == name)
      return value = 0, true;
  return false;
}

//! removes and returns the first word of a line; blanks and tabs separate words unless quoted
inline std::string_view next_table_word(std::string_view& line)
{
  const std::string_view rest = trim(line);
  if (rest.empty() || rest.front() != '"')
    return next_word(line);
  const std::size_t end = rest.find('"', 1);
  if (end == std::string_view::npos)
    return next_word(line);
  line = rest.substr(end + 1);
  return rest.substr(0, end + 1);
}

/*!
  Splits a line into words. The separator ' ' represents any number of blanks and tabs. Between
  other separators, words may be empty. Quoted separators do not split words.
*/
inline void split_table_line(std::string_view line, char separator, Table_words& words)
{
  words.clear();
  if (separator == ' ') {
    for (std::string_view word = next_table_word(line); !word.empty(); word = next_table_word(line))
      words.push_back(word);
    return;
  }
  for (;;) {
    std::size_t begin = line.find_first_not_of(' ');
    if (begin != std::string_view::npos && line[begin] == '"')
      begin = line.find('"', begin + 1); // npos if the quotation mark is not closed
    else
      begin = 0;
    const std::size_t end = line.find(separator, begin == std::string_view::npos ? 0 : begin);
    words.push_back(trim(line.substr(0, end)));
    if (end == std::string_view::npos)
      return;
    line.remove_prefix(end + 1);
  }
}

//! whether blanks separate at least three words, with decimal commas and without other commas
inline bool are_blanks_between_decimal_commas(std::string_view line)
{
  Table_words words;
  split_table_line(line, ' ', words);
  bool has_comma = false;
  for (const std::string_view word : words) {
    if (word.find(',') != std::string_view::npos && !has_decimal_comma(word))
      return false;
    has_comma = has_comma || has_decimal_comma(word);
  }
  return has_comma && words.size() >= 3;
}

/*!
  Returns the separator of a line, the first of this list that applies:
  - a semicolon, if the line has one;
  - a comma, if the line has one, unless the commas are decimal;
  - a tab, if it separates at least three words, and no number is followed by a blank;
  - otherwise ' ', which represents any number of blanks and tabs.
*/
inline char find_separator(std::string_view line)
{
  if (line.find(';') != std::string_view::npos)
    return ';';
  const bool has_comma = line.find(',') != std::string_view::npos;
  if (has_comma && !are_blanks_between_decimal_commas(line))
    return ',';
  Table_words words;
  split_table_line(line, '\t', words);
  const bool has_blanks = std::any_of(words.begin(), words.end(), [](std::string_view word) {
    return word.find(' ') != std::string_view::npos &&
           is_table_number(word.substr(0, word.find(' ')), true);
  });
  return words.size() >= 3 && !has_blanks ? '\t' : ' ';
}

//! removes blanks at both ends; also tabs, unless they separate columns, which may be empty
inline std::string_view trim_table_line(std::string_view line, char separator)
{
  if (separator != '\t')
    return trim(line);
  line.remove_prefix(std::min(line.size(), line.find_first_not_of(' ')));
  while (!line.empty() && line.back() == ' ')
    line.remove_suffix(1);
  return line;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TEXT_TABLE_WORDS_H
