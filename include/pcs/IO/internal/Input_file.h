// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A file read front to back through one small buffer, by bytes or by lines.

#ifndef PCS_IO_INTERNAL_INPUT_FILE_H
#define PCS_IO_INTERNAL_INPUT_FILE_H

#include <pcs/IO/internal/gzip.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <streambuf>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  A file that is compressed by gzip, which its first two bytes show, is unpacked while it is read;
  all positions are those in the unpacked data. Its size is only known after it was unpacked to its
  end, because the size that it states need not be true. `size()` does so once, in a pass of its
  own and without keeping the data. Hence readers compare counts with the true size before they
  allocate memory, and readers that compare no counts need no second pass.
*/
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
    open_plain();
    if (is_gzip()) {
      m_is_compressed = true;
      m_size.reset();
      m_begin = m_end = 0;
      m_file = open_gzip(path);
    }
  }

  const std::string& path() const { return m_path; }
  //! whether the file is compressed by gzip
  bool is_compressed() const { return m_is_compressed; }
  //! returns how commands of a shell in messages refer to the contents of the file
  const char* shell_name() const { return m_is_compressed ? "<(gunzip -c FILE)" : "FILE"; }
  //! returns the number of bytes; the first call unpacks a compressed file to its end
  std::uint64_t size() const
  {
    if (!m_size)
      m_size = count_unpacked();
    return *m_size;
  }
  //! returns the position of the next byte
  std::uint64_t position() const { return m_buffer_position + m_begin; }
  //! returns the number of unread bytes, relative to the size of the file when it was opened
  std::uint64_t remaining() const { return size() > position() ? size() - position() : 0; }
  //! whether there are no more bytes
  bool is_at_end() { return m_begin == m_end && !fill(); }
  //! returns the number of the last line that `read_line()` returned, from 1
  std::uint64_t line_number() const { return m_line_number; }

  //! reads exactly `n` bytes
  void read(void* to, std::size_t n)
  {
    if (read_at_most(to, n) < n)
      fail_at_end();
  }

  //! reads `n` bytes, or fewer at the end of the file; returns their number
  std::size_t read_at_most(void* to, std::size_t n)
  {
    auto* out = static_cast<char*>(to);
    std::size_t left = n;
    while (left > 0 && !is_at_end()) {
      const std::size_t step = std::min(left, m_end - m_begin);
      std::memcpy(out, m_buffer.data() + m_begin, step);
      m_begin += step;
      out += step;
      left -= step;
    }
    return n - left;
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
    if (to >= m_buffer_position && to - m_buffer_position <= m_end) { // is in the buffer
      m_begin = static_cast<std::size_t>(to - m_buffer_position);
      return;
    }
    const auto target = static_cast<std::streamoff>(to);
    if (m_file->pubseekoff(target, std::ios::beg, std::ios::in) != std::streampos(target))
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
    m_is_last_line_open = true;
    return true;
  }
  //! whether the last line that `read_line()` returned ended with the file, without a line break
  bool is_last_line_open() const { return m_is_last_line_open; }

  [[noreturn]] void fail_at_line(const std::string& what) const
  {
    throw IO_error(m_path, "line " + std::to_string(m_line_number) + ": " + what);
  }
  [[noreturn]] void fail_at_byte(std::uint64_t byte, const std::string& what) const
  {
    throw IO_error(m_path,
                   "byte " + std::to_string(byte) +
                       (m_is_compressed ? " of the unpacked file: " : ": ") + what);
  }
  [[noreturn]] void fail_at_end() const
  {
    fail_at_byte(size(), "the file ends here, more data was expected");
  }

private:
  static constexpr std::size_t buffer_size = std::size_t(1) << 18;
  // bounds the memory of a line; lines of points and faces in real files are far shorter
  static constexpr std::size_t longest_line = std::size_t(1) << 24;

  void open_plain()
  {
    auto file = std::make_unique<std::filebuf>();
    file->pubsetbuf(nullptr, 0); // this class buffers the file itself
    if (file->open(m_path, std::ios::in | std::ios::binary) == nullptr)
      throw IO_error(m_path, "cannot be opened for reading");
    m_file = std::move(file);
  }

  //! compares the first bytes, which remain unread
  bool is_gzip()
  {
    return fill() && m_end >= gzip_magic.size() &&
           std::equal(gzip_magic.begin(), gzip_magic.end(), m_buffer.begin(), [](auto a, auto b) {
             return a == static_cast<unsigned char>(b);
           });
  }

  std::uint64_t count_unpacked() const
  {
    const std::unique_ptr<std::streambuf> file = open_gzip(m_path);
    std::vector<char> bytes(buffer_size);
    std::uint64_t count = 0;
    for (std::streamsize n = 1; n > 0; count += static_cast<std::uint64_t>(n))
      n = file->sgetn(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return count;
  }

  static std::string_view without_carriage_return(std::string_view line)
  {
    if (!line.empty() && line.back() == '\r')
      line.remove_suffix(1);
    return line;
  }

  std::size_t read_some(std::size_t at)
  {
    const auto n =
        m_file->sgetn(m_buffer.data() + at, static_cast<std::streamsize>(m_buffer.size() - at));
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
  std::unique_ptr<std::streambuf> m_file;
  mutable std::optional<std::uint64_t> m_size; // not known yet of a compressed file
  bool m_is_compressed = false;
  std::vector<char> m_buffer;
  std::uint64_t m_buffer_position = 0; // of the first byte of the buffer in the file
  std::size_t m_begin = 0, m_end = 0;  // unread part of the buffer
  std::uint64_t m_line_number = 0;
  bool m_is_last_line_open = false;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_INPUT_FILE_H
