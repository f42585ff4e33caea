// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A file read front to back through one small buffer, by bytes or by lines.

#ifndef PCS_IO_INTERNAL_INPUT_FILE_H
#define PCS_IO_INTERNAL_INPUT_FILE_H

#include <pcs/core/errors.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

class Input_file
{
public:
  explicit Input_file(const std::string& path) : m_path(path), m_buffer(buffer_size)
  {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
      throw IO_error(path, "there is no such file");
    if (!std::filesystem::is_regular_file(status))
      throw IO_error(path, "expected a regular file");
    m_size = std::filesystem::file_size(path, error);
    if (error)
      throw IO_error(path, "cannot be read: " + error.message());
    m_file.pubsetbuf(nullptr, 0); // this class buffers the file itself
    if (m_file.open(path, std::ios::in | std::ios::binary) == nullptr)
      throw IO_error(path, "cannot be opened for reading");
  }

  const std::string& path() const { return m_path; }
  std::uint64_t size() const { return m_size; }
  //! returns the position of the next byte
  std::uint64_t position() const { return m_buffer_position + m_begin; }
  //! returns the number of unread bytes, relative to the size of the file when it was opened
  std::uint64_t remaining() const { return m_size > position() ? m_size - position() : 0; }
  //! returns the number of the last line that `read_line()` returned, from 1
  std::uint64_t line_number() const { return m_line_number; }

  //! reads exactly `n` bytes
  void read(void* to, std::size_t n)
  {
    auto* out = static_cast<char*>(to);
    while (n > 0) {
      if (m_begin == m_end && !fill())
        fail_at_end();
      const std::size_t step = std::min(n, m_end - m_begin);
      std::memcpy(out, m_buffer.data() + m_begin, step);
      m_begin += step;
      out += step;
      n -= step;
    }
  }

  //! skips `n` bytes
  void skip(std::uint64_t n)
  {
    if (n > remaining())
      fail_at_end();
    if (n <= m_end - m_begin)
      m_begin += static_cast<std::size_t>(n);
    else
      seek(position() + n);
  }

  //! moves to the byte `to` of the file
  void seek(std::uint64_t to)
  {
    const auto target = static_cast<std::streamoff>(to);
    if (m_file.pubseekoff(target, std::ios::beg, std::ios::in) != std::streampos(target))
      throw IO_error(m_path, "cannot move to byte " + std::to_string(to));
    m_buffer_position = to;
    m_begin = m_end = 0;
  }

  /*!
    Reads a line without its line break (LF or CRLF). The view is valid until the next call.
    Returns false at the end of the file.
  */
  bool read_line(std::string_view& line)
  {
    std::size_t searched = 0;
    for (;;) {
      const char* first = m_buffer.data() + m_begin;
      const std::size_t available = m_end - m_begin;
      const void* hit = available > searched
                            ? std::memchr(first + searched, '\n', available - searched)
                            : nullptr;
      if (hit != nullptr) {
        const auto length = static_cast<std::size_t>(static_cast<const char*>(hit) - first);
        line = without_carriage_return(std::string_view(first, length));
        m_begin += length + 1;
        ++m_line_number;
        return true;
      }
      searched = available;
      if (!fill_behind())
        break;
    }
    if (m_begin == m_end)
      return false;
    line = without_carriage_return(std::string_view(m_buffer.data() + m_begin, m_end - m_begin));
    m_begin = m_end;
    ++m_line_number;
    return true;
  }

  [[noreturn]] void fail_at_line(const std::string& what) const
  {
    throw IO_error(m_path, "line " + std::to_string(m_line_number) + ": " + what);
  }
  [[noreturn]] void fail_at_byte(std::uint64_t byte, const std::string& what) const
  {
    throw IO_error(m_path, "byte " + std::to_string(byte) + ": " + what);
  }
  [[noreturn]] void fail_at_end() const
  {
    fail_at_byte(m_size, "the file ends here, more data was expected");
  }

private:
  static constexpr std::size_t buffer_size = std::size_t(1) << 18;
  // bounds the memory of a line; lines of points and faces in real files are far shorter
  static constexpr std::size_t longest_line = std::size_t(1) << 24;

  static std::string_view without_carriage_return(std::string_view line)
  {
    if (!line.empty() && line.back() == '\r')
      line.remove_suffix(1);
    return line;
  }

  std::size_t read_some(std::size_t at)
  {
    const auto n =
        m_file.sgetn(m_buffer.data() + at, static_cast<std::streamsize>(m_buffer.size() - at));
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }

  //! replaces the contents of the buffer
  bool fill()
  {
    m_buffer_position += m_end;
    m_begin = 0;
    m_end = read_some(0);
    return m_end > 0;
  }

  //! keeps the unread contents of the buffer and appends more
  bool fill_behind()
  {
    const std::size_t kept = m_end - m_begin;
    if (kept > longest_line)
      throw IO_error(m_path,
                     "line " + std::to_string(m_line_number + 1) + " is longer than " +
                         std::to_string(longest_line) + " bytes");
    std::memmove(m_buffer.data(), m_buffer.data() + m_begin, kept);
    m_buffer_position += m_begin;
    m_begin = 0;
    m_end = kept;
    if (2 * kept > m_buffer.size())
      m_buffer.resize(2 * m_buffer.size());
    const std::size_t n = read_some(kept);
    m_end += n;
    return n > 0;
  }

  std::string m_path;
  std::filebuf m_file;
  std::uint64_t m_size = 0;
  std::vector<char> m_buffer;
  std::uint64_t m_buffer_position = 0; // of the first byte of the buffer in the file
  std::size_t m_begin = 0, m_end = 0;  // unread part of the buffer
  std::uint64_t m_line_number = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_INPUT_FILE_H
