// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Unpacks files that are compressed by gzip (RFC 1952) while they are read, if pcs has zlib.

#ifndef PCS_IO_INTERNAL_GZIP_H
#define PCS_IO_INTERNAL_GZIP_H

#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <streambuf>
#include <string>
#include <vector>

#ifdef PCS_WITH_ZLIB
#include <zlib.h>
#endif

namespace pcs {
namespace IO {
namespace internal {

//! the first two bytes of every gzip file
constexpr std::array<unsigned char, 2> gzip_magic = {0x1f, 0x8b};

#ifdef PCS_WITH_ZLIB

/*
  The unpacked bytes of a gzip file, front to back. A file may consist of several members, whose
  contents follow each other, and may end with zeros. zlib compares the length and the checksum of
  every member, so that a file that was read to its end is complete. Memory: 0.1 MB for any size.
*/
class Gzip_buffer : public std::streambuf
{
public:
  explicit Gzip_buffer(const std::string& path) : m_path(path), m_packed(buffer_size)
  {
    m_file.pubsetbuf(nullptr, 0); // this class buffers the file itself
    if (m_file.open(path, std::ios::in | std::ios::binary) == nullptr)
      throw IO_error(path, "cannot be opened for reading");
    constexpr int largest_window = 15, with_gzip_header = 16;
    if (inflateInit2(&m_zlib, largest_window + with_gzip_header) != Z_OK)
      throw IO_error(path, "zlib cannot be started");
  }
  Gzip_buffer(const Gzip_buffer&) = delete;
  Gzip_buffer& operator=(const Gzip_buffer&) = delete;
  ~Gzip_buffer() override { inflateEnd(&m_zlib); }

protected:
  //! unpacks `n` bytes, or fewer at the end of the data
  std::streamsize xsgetn(char* to, std::streamsize n) override
  {
    std::streamsize done = 0;
    while (done < n && !m_is_at_end) {
      const auto room = static_cast<uInt>(
          std::min<std::streamsize>(n - done, std::numeric_limits<std::int32_t>::max()));
      m_zlib.next_out = reinterpret_cast<Bytef*>(to + done);
      m_zlib.avail_out = room;
      if (m_zlib.avail_in == 0)
        read_packed();
      const int result = inflate(&m_zlib, Z_NO_FLUSH);
      done += static_cast<std::streamsize>(room - m_zlib.avail_out);
      if (result == Z_STREAM_END)
        begin_next_member();
      else if (result == Z_BUF_ERROR) // no progress: there is no input
        fail("the data end before they are complete; the file may be incomplete, copy it again");
      else if (result != Z_OK)
        fail(std::string("the data are damaged (") +
             (m_zlib.msg != nullptr ? m_zlib.msg : "unknown error of zlib") +
             "); copy the file again, gzip -t FILE checks it");
    }
    m_position += done;
    return done;
  }

  //! moves to a position of the unpacked data; a move back unpacks the file from its beginning
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode) override
  {
    if (from != std::ios::beg || offset < 0)
      return pos_type(off_type(-1));
    if (offset < m_position)
      rewind();
    std::vector<char> skipped(
        static_cast<std::size_t>(std::min<off_type>(offset - m_position, off_type(buffer_size))));
    while (m_position < offset) {
      const off_type step = std::min<off_type>(offset - m_position, off_type(skipped.size()));
      if (xsgetn(skipped.data(), step) == 0)
        return pos_type(off_type(-1)); // behind the end
    }
    return pos_type(m_position);
  }

private:
  static constexpr std::size_t buffer_size = std::size_t(1) << 16;

  [[noreturn]] void fail(const std::string& what) const
  {
    throw IO_error(m_path,
                   "byte " + std::to_string(m_packed_end - m_zlib.avail_in) +
                       " of the gzip file: " + what);
  }

  //! refills the buffer of packed bytes; returns false at the end of the file
  bool read_packed()
  {
    const auto n = m_file.sgetn(m_packed.data(), static_cast<std::streamsize>(m_packed.size()));
    m_zlib.next_in = reinterpret_cast<Bytef*>(m_packed.data());
    m_zlib.avail_in = n > 0 ? static_cast<uInt>(n) : 0;
    m_packed_end += m_zlib.avail_in;
    return n > 0;
  }

  void begin_next_member()
  {
    bool has_padding = false;
    for (;;) {
      if (m_zlib.avail_in == 0 && !read_packed()) {
        m_is_at_end = true;
        return;
      }
      if (*m_zlib.next_in != 0)
        break;
      has_padding = true;
      ++m_zlib.next_in;
      --m_zlib.avail_in;
    }
    if (has_padding || *m_zlib.next_in != gzip_magic[0])
      fail("expected the end of the file or further gzip data; remove the bytes from here on");
    inflateReset(&m_zlib);
  }

  void rewind()
  {
    if (m_file.pubseekoff(0, std::ios::beg, std::ios::in) != std::streampos(0))
      throw IO_error(m_path, "cannot move to byte 0");
    inflateReset(&m_zlib);
    m_zlib.avail_in = 0;
    m_packed_end = 0;
    m_position = 0;
    m_is_at_end = false;
  }

  std::string m_path;
  std::filebuf m_file;
  std::vector<char> m_packed;
  std::uint64_t m_packed_end = 0; // position in the file behind the packed bytes
  off_type m_position = 0;        // in the unpacked data
  bool m_is_at_end = false;
  z_stream m_zlib{};
};

#endif // PCS_WITH_ZLIB

//! opens a gzip file, from which the unpacked bytes are read; throws without zlib
inline std::unique_ptr<std::streambuf> open_gzip(const std::string& path)
{
#ifdef PCS_WITH_ZLIB
  return std::make_unique<Gzip_buffer>(path);
#else
  throw IO_error(path,
                 "the file is compressed by gzip, and this program was built without zlib; build "
                 "pcs with zlib (package zlib1g-dev, CMake variable PCS_WITH_ZLIB), or unpack the "
                 "file: gunzip -k FILE");
#endif
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_GZIP_H
