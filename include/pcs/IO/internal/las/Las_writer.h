// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Writes points as a LAS file: header, records and uncompressed points.

#ifndef PCS_IO_INTERNAL_LAS_LAS_WRITER_H
#define PCS_IO_INTERNAL_LAS_LAS_WRITER_H

#include <pcs/IO/internal/Format_writer.h>
#include <pcs/IO/internal/las/las_layout.h>
#include <pcs/IO/internal/las/las_metadata.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Write_options.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

/*
  Points from LAS files keep version, point format, VLRs, EVLRs, scale and offset of their file.
  Other points are written as LAS 1.4 with point format 6, or 7 if they have 16 bit colours.
  Properties that the point format lacks are written as extra bytes with a descriptor. Dimensions
  without a property are set to zero.
*/
class Las_writer : public Format_writer
{
public:
  Las_writer(const std::string& path, const Point_schema& schema, const Write_options& options)
    : Las_writer(path, schema, options, Head_later())
  {
    write_head();
  }

protected:
  struct Head_later
  {
  };

  //! prepares header and VLRs, which `write_head()` writes
  Las_writer(const std::string& path,
             const Point_schema& schema,
             const Write_options& options,
             Head_later)
    : Format_writer(path), m_las(schema.las ? *schema.las : make_las_metadata(schema))
  {
    if (options.las_scale)
      m_las.scale = *options.las_scale;
    if (options.las_offset)
      m_las.offset = *options.las_offset;
    if (!schema.las && !(options.las_scale && options.las_offset))
      throw Invalid_input("pcs::IO::Write_options: las_scale and las_offset must be given to write "
                          "LAS in chunks from points that were not read from LAS");
    check_scale();
    std::string error = add_extra_dimensions(m_las, schema);
    if (!error.empty())
      m_file.fail(error);
    m_layout = las_record_layout(m_las);
    m_return_field = find_field("return_number");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      store_header(las_header::scale + 8 * axis, m_las.scale[axis]);
      store_header(las_header::offset + 8 * axis, m_las.offset[axis]);
    }
  }

  //! writes header and VLRs
  void write_head()
  {
    const std::size_t first_point = m_las.header.size() + m_las.vlrs.size();
    if (first_point > std::numeric_limits<std::uint32_t>::max())
      m_file.fail("the variable length records are too long for LAS");
    store_header(las_header::offset_to_points, static_cast<std::uint32_t>(first_point));
    m_file.write(m_las.header.data(), m_las.header.size());
    m_file.write(m_las.vlrs.data(), m_las.vlrs.size());
  }

  //! writes the records of the points
  virtual void write_records(const Row_block& block)
  {
    m_file.write(block.bytes.data(), block.bytes.size());
  }

  //! writes what has to follow the last record
  virtual void finish_records() {}

  //! returns the point format without the mark of compressed points
  unsigned point_format() const
  {
    return m_las.header[las_header::point_format] & (las_header::compressed_bit - 1);
  }

  Las_metadata m_las;

private:
  template <class T>
  void store_header(std::size_t at, T value)
  {
    store_little<T>(m_las.header, at, value);
  }

  void check_scale() const
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!std::isfinite(m_las.scale[axis]) || m_las.scale[axis] == 0 ||
          !std::isfinite(m_las.offset[axis]))
        throw Invalid_input("pcs::IO::Write_options: las_scale must be finite and not zero, "
                            "las_offset must be finite");
  }

  std::size_t find_field(const std::string& name) const
  {
    std::size_t i = 0;
    while (m_layout.fields[i].name != name)
      ++i;
    return i;
  }

  void write_rows(const Row_block& block) override
  {
    const Field& field = m_layout.fields[m_return_field];
    const unsigned mask = (1u << field.number_of_bits) - 1u;
    const unsigned char* row = block.bytes.data();
    for (std::size_t i = 0; i < block.number_of_rows; ++i, row += m_layout.row_size) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto value =
            load<std::int32_t>(row + m_layout.fields[axis].offset, m_layout.do_swap());
        m_low[axis] = std::min(m_low[axis], value);
        m_high[axis] = std::max(m_high[axis], value);
      }
      ++m_by_return[(row[field.offset] >> field.shift) & mask];
    }
    write_records(block);
  }

  void finish(std::uint64_t number_of_points) override
  {
    finish_records();
    const std::uint64_t tail = m_file.position();
    m_file.write(m_las.tail.data(), m_las.tail.size());
    store_counts(number_of_points);
    store_box(number_of_points > 0);
    move_tail(tail);
    m_file.patch(0, m_las.header.data(), m_las.header.size());
  }

  void store_counts(std::uint64_t n)
  {
    const bool is_1_4 = m_las.header[las_header::version_minor] >= 4;
    const bool has_legacy = point_format() < 6 && n <= std::numeric_limits<std::uint32_t>::max();
    if (!is_1_4 && !has_legacy)
      m_file.fail(std::to_string(n) + " points are too many for LAS before version 1.4");
    store_header(las_header::legacy_count, static_cast<std::uint32_t>(has_legacy ? n : 0));
    for (std::size_t i = 0; i < 5; ++i)
      store_header(las_header::legacy_by_return + 4 * i,
                   static_cast<std::uint32_t>(has_legacy ? m_by_return[i + 1] : 0));
    if (!is_1_4)
      return;
    store_header(las_header::count, n);
    for (std::size_t i = 0; i < 15; ++i)
      store_header(las_header::by_return + 8 * i, m_by_return[i + 1]);
  }

  void store_box(bool has_points)
  {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double a = has_points ? m_low[axis] * m_las.scale[axis] + m_las.offset[axis] : 0;
      const double b = has_points ? m_high[axis] * m_las.scale[axis] + m_las.offset[axis] : 0;
      store_header(las_header::box + 16 * axis, std::max(a, b)); // a scale may be negative
      store_header(las_header::box + 16 * axis + 8, std::min(a, b));
    }
  }

  //! updates the positions in the header that refer to data after the points
  void move_tail(std::uint64_t new_position)
  {
    const unsigned minor = m_las.header[las_header::version_minor];
    const auto move = [&](std::size_t at) {
      const auto old = load_little<std::uint64_t>(m_las.header, at);
      if (old >= m_las.tail_position && !m_las.tail.empty())
        store_header(at, old - m_las.tail_position + new_position);
    };
    if (minor >= 3)
      move(las_header::waveforms);
    if (minor >= 4)
      move(las_header::first_evlr);
  }

  std::size_t m_return_field = 0;
  std::array<std::uint64_t, 16> m_by_return{};
  std::array<std::int32_t, 3> m_low = {INT32_MAX, INT32_MAX, INT32_MAX};
  std::array<std::int32_t, 3> m_high = {INT32_MIN, INT32_MIN, INT32_MIN};
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_LAS_LAS_WRITER_H
