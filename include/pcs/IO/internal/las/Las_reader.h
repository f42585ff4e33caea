// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads a LAS file: header, records and uncompressed points.

#ifndef PCS_IO_INTERNAL_LAS_LAS_READER_H
#define PCS_IO_INTERNAL_LAS_LAS_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/las/las_layout.h>
#include <pcs/IO/internal/numbers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

/*
  Reads LAS 1.0 to 1.4 with point formats 0 to 10. Header, VLRs and all data after the points are
  stored as bytes in the schema, so that they can be written again.
*/
class Las_reader : public Format_reader
{
public:
  explicit Las_reader(const std::string& path) : Las_reader(path, false)
  {
    m_file.seek(m_first_point);
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rows, m_rows_left));
    start_block(block, n);
    for (std::size_t i = 0; i < n; ++i)
      block.locations.push_back(m_file.position() + i * m_layout.row_size);
    m_file.read(block.bytes.data(), block.bytes.size());
    block.number_of_rows = n;
    m_rows_left -= n;
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    m_file.fail_at_byte(location, what);
  }

protected:
  //! reads all but the points, which may be compressed
  Las_reader(const std::string& path, bool is_compressed)
    : m_file(path), m_las(std::make_shared<Las_metadata>()), m_is_compressed(is_compressed)
  {
    read_header();
    read_scale();
    read_vlrs();
    read_count();
    read_tail();
    make_schema();
    m_rows_left = *m_number_of_points;
  }

  template <class T>
  T header(std::size_t at) const
  {
    return load_little<T>(m_las->header, at);
  }

private:
  void read_header()
  {
    m_las->header.resize(las_header::size_1_2);
    m_file.read(m_las->header.data(), 4);
    if (std::string(m_las->header.begin(), m_las->header.begin() + 4) != "LASF")
      m_file.fail_at_byte(0, "expected 'LASF'");
    m_file.read(m_las->header.data() + 4, las_header::size_1_2 - 4);
    m_minor = m_las->header[las_header::version_minor];
    if (m_las->header[las_header::version_major] != 1 || m_minor > 4)
      m_file.fail_at_byte(las_header::version_major, "expected LAS version 1.0 to 1.4");
    const std::size_t size = header<std::uint16_t>(las_header::header_size);
    const std::size_t least = m_minor < 3    ? las_header::size_1_2
                              : m_minor == 3 ? las_header::size_1_3
                                             : las_header::size_1_4;
    if (size < least)
      m_file.fail_at_byte(las_header::header_size,
                          "expected a header of at least " + std::to_string(least) +
                              " bytes, found " + std::to_string(size));
    m_las->header.resize(size);
    m_file.read(m_las->header.data() + las_header::size_1_2, size - las_header::size_1_2);
    check_point_format();
  }

  void check_point_format()
  {
    unsigned format = m_las->header[las_header::point_format];
    if (format < las_header::compressed_bit && m_is_compressed)
      m_file.fail_at_byte(las_header::point_format, "expected compressed points");
    if (m_is_compressed)
      format -= las_header::compressed_bit;
    m_las->header[las_header::point_format] = static_cast<unsigned char>(format);
    if (format > largest_point_format)
      m_file.fail_at_byte(las_header::point_format,
                          "expected a point format of 0 to 10, found " + std::to_string(format));
    const std::size_t length = header<std::uint16_t>(las_header::record_length);
    const std::size_t least = las_point_layout(format).row_size;
    if (length < least)
      m_file.fail_at_byte(las_header::record_length,
                          "expected point records of at least " + std::to_string(least) +
                              " bytes, found " + std::to_string(length));
  }

  void read_scale()
  {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      m_las->scale[axis] = header<double>(las_header::scale + 8 * axis);
      m_las->offset[axis] = header<double>(las_header::offset + 8 * axis);
      if (!std::isfinite(m_las->scale[axis]) || m_las->scale[axis] == 0)
        m_file.fail_at_byte(las_header::scale + 8 * axis,
                            "expected a scale factor that is finite and not zero");
      if (!std::isfinite(m_las->offset[axis]))
        m_file.fail_at_byte(las_header::offset + 8 * axis, "expected a finite offset");
    }
  }

  void read_vlrs()
  {
    m_first_point = header<std::uint32_t>(las_header::offset_to_points);
    if (m_first_point < m_las->header.size() || m_first_point > m_file.size())
      m_file.fail_at_byte(las_header::offset_to_points,
                          "expected the points after the header and inside the file, not at byte " +
                              std::to_string(m_first_point));
    m_las->vlrs.resize(static_cast<std::size_t>(m_first_point) - m_las->header.size());
    m_file.read(m_las->vlrs.data(), m_las->vlrs.size());
    const auto n = header<std::uint32_t>(las_header::number_of_vlrs);
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::size_t left = m_las->vlrs.size() - at;
      if (left < vlr_header_size ||
          left - vlr_header_size < load_little<std::uint16_t>(m_las->vlrs, at + las_vlr::length))
        m_file.fail_at_byte(m_las->header.size() + at,
                            "variable length record " + std::to_string(i) + " of " +
                                std::to_string(n) + " reaches into the points");
      at += vlr_header_size + load_little<std::uint16_t>(m_las->vlrs, at + las_vlr::length);
    }
  }

  void read_count()
  {
    const std::uint64_t legacy = header<std::uint32_t>(las_header::legacy_count);
    std::uint64_t count = legacy;
    if (m_minor >= 4) {
      count = header<std::uint64_t>(las_header::count);
      if (count == 0)
        count = legacy;
      if (legacy != 0 && legacy != count)
        m_file.fail_at_byte(las_header::count,
                            "the two numbers of points differ: " + std::to_string(legacy) +
                                " and " + std::to_string(count));
    }
    const std::uint64_t length = header<std::uint16_t>(las_header::record_length);
    if (m_is_compressed) {
      m_number_of_points = count;
      m_las->tail_position = find_compressed_tail();
      return;
    }
    if (count > (m_file.size() - m_first_point) / length)
      m_file.fail_at_byte(m_minor >= 4 ? las_header::count : las_header::legacy_count,
                          "the file is too small for " + std::to_string(count) + " points of " +
                              std::to_string(length) + " bytes");
    m_number_of_points = count;
    m_las->tail_position = m_first_point + count * length;
  }

  //! returns the first byte of extended records or waveforms after compressed points
  std::uint64_t find_compressed_tail() const
  {
    const std::uint64_t waveforms = m_minor >= 3 ? header<std::uint64_t>(las_header::waveforms) : 0;
    const std::uint32_t n = m_minor >= 4 ? header<std::uint32_t>(las_header::number_of_evlrs) : 0;
    std::uint64_t tail = m_file.size();
    if (waveforms != 0)
      tail = std::min(tail, waveforms);
    if (n > 0)
      tail = std::min(tail, header<std::uint64_t>(las_header::first_evlr));
    if (tail < m_first_point)
      m_file.fail_at_byte(n > 0 ? las_header::first_evlr : las_header::waveforms,
                          "expected extended records and waveforms after the points");
    return tail;
  }

  //! stores extended records and waveforms unchanged
  void read_tail()
  {
    const std::uint64_t waveforms = m_minor >= 3 ? header<std::uint64_t>(las_header::waveforms) : 0;
    const std::uint32_t n = m_minor >= 4 ? header<std::uint32_t>(las_header::number_of_evlrs) : 0;
    const std::uint64_t tail_size = m_file.size() - m_las->tail_position;
    if (waveforms != 0 && (waveforms < m_las->tail_position || waveforms > m_file.size()))
      m_file.fail_at_byte(las_header::waveforms,
                          "expected the waveforms after the points and inside the file");
    if (n == 0 && waveforms == 0) {
      if (tail_size > 0)
        m_file.fail_at_byte(m_las->tail_position,
                            "expected the end of the file, found " + std::to_string(tail_size) +
                                " more bytes");
      return;
    }
    if (n > 0)
      check_evlrs(n);
    m_file.seek(m_las->tail_position);
    m_las->tail.resize(static_cast<std::size_t>(tail_size));
    m_file.read(m_las->tail.data(), m_las->tail.size());
  }

  void check_evlrs(std::uint32_t n)
  {
    std::uint64_t at = header<std::uint64_t>(las_header::first_evlr);
    if (at < m_las->tail_position)
      m_file.fail_at_byte(las_header::first_evlr,
                          "expected the extended variable length records after the points");
    for (std::uint32_t i = 0; i < n; ++i) {
      std::array<unsigned char, evlr_header_size> record{};
      if (at > m_file.size() || m_file.size() - at < record.size())
        m_file.fail_at_end();
      m_file.seek(at);
      m_file.read(record.data(), record.size());
      at += record.size();
      const auto length = load_little<std::uint64_t>(record, las_vlr::length);
      if (length > m_file.size() - at)
        m_file.fail_at_byte(at,
                            "extended variable length record " + std::to_string(i) +
                                " is longer than the file");
      at += length;
    }
  }

  void make_schema()
  {
    m_schema.format = File_format::las;
    m_schema.las = m_las;
    m_layout = las_record_layout(*m_las);
    m_schema.properties.clear();
    for (const Field& field : m_layout.fields)
      m_schema.properties.push_back(
          {field.name, is_coordinate_name(field.name) ? Scalar_type::float64 : field.type});
  }

protected:
  Input_file m_file;
  std::shared_ptr<Las_metadata> m_las;
  bool m_is_compressed;
  unsigned m_minor = 0;
  std::uint64_t m_first_point = 0; // [byte]
  std::uint64_t m_rows_left = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_LAS_LAS_READER_H
