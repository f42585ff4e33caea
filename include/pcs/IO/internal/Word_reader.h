// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a text file word by word, with line numbers in the errors.

#ifndef PCS_IO_INTERNAL_WORD_READER_H
#define PCS_IO_INTERNAL_WORD_READER_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pcs {
namespace IO {
namespace internal {

/// Reads the words of a file; errors contain line numbers.
class Word_reader
{
public:
  explicit Word_reader(const std::string& path) : m_file(path) {}

  template <class T>
  T number(const char* what)
  {
    T value{};
    const std::string_view word = next();
    if (word.empty() || parse_number(word, value) != Parse_result::ok)
      m_file.fail_at_line(std::string("expected ") + what + ", found " + found(word));
    return value;
  }

  std::string word(const char* what)
  {
    const std::string_view text = next();
    if (text.empty())
      m_file.fail_at_line(std::string("expected ") + what + ", found the end of the file");
    return std::string(text);
  }

  std::size_t count(const char* what)
  {
    const auto value = number<std::int64_t>(what);
    if (value < 0 || static_cast<std::uint64_t>(value) > m_file.size())
      m_file.fail_at_line(std::string("expected ") + what + ", found " + std::to_string(value));
    return static_cast<std::size_t>(value);
  }

  double real(const char* what)
  {
    const auto value = number<double>(what);
    if (!std::isfinite(value))
      m_file.fail_at_line(std::string("expected a finite ") + what);
    return value;
  }

  void expect(std::string_view text)
  {
    const std::string_view word = next();
    if (word != text)
      m_file.fail_at_line("expected '" + std::string(text) + "', found " + found(word));
  }

  /// Reads the next word if it is `text`, and returns whether it is.
  bool skip(std::string_view text)
  {
    if (next() == text)
      return true;
    m_pushed_back = m_word;
    return false;
  }

  bool is_at_end() { return next().empty(); }
  /// Fails if there are further words, or if the last line has no end: it may have been cut in a
  /// number.
  void expect_end()
  {
    if (!is_at_end())
      fail("expected the end of the file");
    if (m_file.is_last_line_open())
      fail("the last line has no end, so the file is probably not complete; write it again");
  }
  [[noreturn]] void fail(const std::string& what) const { m_file.fail_at_line(what); }

private:
  static std::string found(std::string_view word)
  {
    return word.empty() ? "the end of the file" : in_quotes(word);
  }

  std::string_view next()
  {
    if (!m_pushed_back.empty()) {
      m_word = m_pushed_back;
      m_pushed_back = {};
      return m_word;
    }
    m_word = next_word(m_line);
    while (m_word.empty() && m_file.read_line(m_line))
      m_word = next_word(m_line);
    return m_word;
  }

  Input_file m_file;
  std::string_view m_line, m_word, m_pushed_back;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_WORD_READER_H
