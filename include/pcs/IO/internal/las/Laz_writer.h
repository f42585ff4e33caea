// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as a LAZ file, if pcs is built with LASzip.

#ifndef PCS_IO_INTERNAL_LAS_LAZ_WRITER_H
#define PCS_IO_INTERNAL_LAS_LAZ_WRITER_H

#ifdef PCS_WITH_LASZIP

#include <pcs/IO/internal/Output_file.h>
#include <pcs/IO/internal/las/Las_writer.h>
#include <pcs/IO/internal/las/las_layout.h>
#include <pcs/IO/internal/las/laszip_point.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Write_options.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <ostream>
#include <streambuf>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

/*
  What LASzip writes, in an output file whose head is written already. LASzip neither reports why a
  write failed nor frees its memory then. Hence the first error is kept for `check()`, which throws
  it, and what is written after it is dropped.
*/
class Output_buffer : public std::streambuf
{
public:
  explicit Output_buffer(Output_file& file) : m_file(file) {}

  //! begins at the end of what is written
  void start() { m_position = m_end = m_file.position(); }

  void check() const
  {
    if (m_error)
      std::rethrow_exception(m_error);
  }

protected:
  std::streamsize xsputn(const char* from, std::streamsize n) override
  {
    const auto size = static_cast<std::size_t>(n);
    try {
      if (!m_error && m_position == m_end)
        m_file.write(from, size);
      else if (!m_error)
        m_file.patch(m_position, from, size);
    } catch (...) {
      m_error = std::current_exception();
    }
    m_position += size;
    m_end = std::max(m_end, m_position);
    return n;
  }

  int_type overflow(int_type c) override
  {
    const char byte = traits_type::to_char_type(c);
    if (!traits_type::eq_int_type(c, traits_type::eof()))
      xsputn(&byte, 1);
    return traits_type::not_eof(c);
  }

  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode) override
  {
    const std::size_t base = from == std::ios::beg ? 0 : from == std::ios::cur ? m_position : m_end;
    const off_type to = static_cast<off_type>(base) + offset;
    if (to < 0 || to > static_cast<off_type>(m_end))
      return pos_type(off_type(-1));
    m_position = static_cast<std::size_t>(to);
    return pos_type(to);
  }

  pos_type seekpos(pos_type to, std::ios::openmode which) override
  {
    return seekoff(off_type(to), std::ios::beg, which);
  }

private:
  Output_file& m_file;
  std::size_t m_position = 0, m_end = 0; // of the next byte, and behind the last one in the file
  std::exception_ptr m_error;
};

/*
  Header, VLRs, EVLRs and records are those of `Las_writer`, and a VLR of LASzip that describes the
  compression. Point formats from 6 on are compressed in the way that LAS 1.4 has for them.
*/
class Laz_writer : public Las_writer
{
public:
  Laz_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Las_writer(path, schema, options, Head_later()), m_buffer(m_file), m_stream(&m_buffer)
  {
    if (laszip_create(&m_laszip.handle) != 0)
      m_file.fail("LASzip cannot be started");
    m_format = point_format();
    m_number_of_extra_bytes = m_layout.row_size - las_point_layout(m_format).row_size;
    check(laszip_set_point_type_and_size(m_laszip.handle,
                                         static_cast<laszip_U8>(m_format),
                                         static_cast<laszip_U16>(m_layout.row_size)));
    check(laszip_request_native_extension(m_laszip.handle, 1));
    insert_laszip_vlr();
    m_las.header[las_header::point_format] |= las_header::compressed_bit;
    write_head();
    m_buffer.start();
    check(laszip_open_writer_stream(m_laszip.handle, m_stream, 1, 1)); // without header
    m_laszip.is_open = true;
    check(laszip_get_point_pointer(m_laszip.handle, &m_point));
    if (m_number_of_extra_bytes > 0 &&
        m_point->num_extra_bytes != static_cast<laszip_I32>(m_number_of_extra_bytes))
      m_file.fail("LASzip cannot compress point records of " + std::to_string(m_layout.row_size) +
                  " bytes");
  }

private:
  struct Handle
  {
    Handle() = default;
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle()
    {
      if (handle == nullptr)
        return;
      if (is_open)
        laszip_close_writer(handle);
      laszip_destroy(handle);
    }
    laszip_POINTER handle = nullptr;
    bool is_open = false;
  };

  void check(laszip_I32 result) const
  {
    m_buffer.check();
    if (result == 0)
      return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(m_laszip.handle, &message);
    m_file.fail(std::string("the points cannot be compressed: ") +
                (message != nullptr ? message : "unknown error of LASzip") +
                "; write a file with the extension las");
  }

  //! inserts the description of the compression behind the VLRs, which may be followed by padding
  void insert_laszip_vlr()
  {
    laszip_U8* vlr = nullptr;
    laszip_U32 size = 0;
    check(laszip_create_laszip_vlr(m_laszip.handle, &vlr, &size));
    const auto n = load_little<std::uint32_t>(m_las.header, las_header::number_of_vlrs);
    std::size_t end = 0;
    for (std::uint32_t i = 0; i < n; ++i)
      end += vlr_header_size + load_little<std::uint16_t>(m_las.vlrs, end + las_vlr::length);
    m_las.vlrs.insert(m_las.vlrs.begin() + static_cast<std::ptrdiff_t>(end), vlr, vlr + size);
    store_little<std::uint32_t>(m_las.header, las_header::number_of_vlrs, n + 1);
  }

  void write_records(const Row_block& block) override
  {
    const unsigned char* row = block.bytes.data();
    for (std::size_t i = 0; i < block.number_of_rows; ++i, row += m_layout.row_size) {
      Record_reader record(row);
      take_record(record, m_format, *m_point);
      record.take_bytes(m_point->extra_bytes, m_number_of_extra_bytes);
      check(laszip_write_point(m_laszip.handle));
    }
  }

  void finish_records() override
  {
    m_laszip.is_open = false;
    check(laszip_close_writer(m_laszip.handle));
  }

  Output_buffer m_buffer;
  std::ostream m_stream;
  Handle m_laszip; // is destroyed before the stream, to which it writes
  laszip_point_struct* m_point = nullptr;
  unsigned m_format = 0;
  std::size_t m_number_of_extra_bytes = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_WITH_LASZIP

#endif // PCS_IO_INTERNAL_LAS_LAZ_WRITER_H
