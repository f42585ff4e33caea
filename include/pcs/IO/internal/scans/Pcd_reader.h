// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads PCD files of the Point Cloud Library: ascii, binary and compressed.

#ifndef PCS_IO_INTERNAL_SCANS_PCD_READER_H
#define PCS_IO_INTERNAL_SCANS_PCD_READER_H

#include <pcs/IO/internal/Format_reader.h>
#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/scans/lzf.h>
#include <pcs/IO/internal/scans/pcd_header.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

/*
  Fields are properties of their own type. Fields with several values are name_0, name_1, ..., the
  field rgb is red, green and blue, the normal is nx, ny, nz, and fields named _ are padding. Points
  whose coordinates are NaN are pixels without return and are left out. Compressed files are
  decompressed in memory.
*/
class Pcd_reader : public Format_reader
{
public:
  explicit Pcd_reader(const std::string& path) : m_file(path)
  {
    m_schema.format = File_format::pcd;
    m_schema.properties.clear();
    m_header = Pcd_header_reader(m_file).read();
    m_layout.is_big_endian = m_header.encoding == Pcd_encoding::ascii && is_big_endian_machine();
    for (const Pcd_field& field : m_header.fields)
      add_field(field);
    for (const char* name : {"x", "y", "z"})
      if (!m_schema.has(name))
        m_file.fail_at_line("expected the fields x, y and z; '" + std::string(name) +
                            "' is missing");
    const std::string twice = first_duplicate(m_schema);
    if (!twice.empty())
      m_file.fail_at_line("the field " + in_quotes(twice) + " is there twice");
    check_size();
    m_rows_left = m_header.number_of_points;
    if (m_header.encoding == Pcd_encoding::compressed)
      decompress();
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    do {
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rows, m_rows_left));
      start_block(block, n);
      for (std::size_t i = 0; i < n; ++i) {
        unsigned char* row = block.bytes.data() + block.number_of_rows * m_layout.row_size;
        block.locations.resize(block.number_of_rows);
        block.locations.push_back(read_row(row));
        --m_rows_left;
        if (!is_without_return(row))
          ++block.number_of_rows;
      }
    } while (block.number_of_rows == 0 && m_rows_left > 0);
    if (m_rows_left == 0)
      check_end();
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(),
                   (m_header.encoding == Pcd_encoding::ascii ? "line " : "byte ") +
                       std::to_string(location) + ": " + what);
  }

private:
  static bool is_packed_color(const Pcd_field& field)
  {
    return (field.name == "rgb" || field.name == "rgba") && size_of(field.type) == 4 &&
           field.count == 1;
  }

  void add(const std::string& name, Scalar_type type)
  {
    m_layout.push_back(name, type);
    m_schema.properties.push_back({name, is_coordinate_name(name) ? Scalar_type::float64 : type});
  }

  void add_field(const Pcd_field& field)
  {
    if (field.name == "_") {
      m_layout.row_size += field.size();
    } else if (is_packed_color(field)) {
      for (const char* name : {"blue", "green", "red"})
        add(name, Scalar_type::uint8);
      if (field.name == "rgba")
        add("alpha", Scalar_type::uint8);
      else
        m_layout.row_size += 1;
    } else if (field.count > 1) {
      for (std::size_t i = 0; i < field.count; ++i)
        add(field.name + "_" + std::to_string(i), field.type);
    } else {
      const bool is_normal = field.name.size() == 8 && field.name.rfind("normal_", 0) == 0;
      add(is_normal ? std::string("n") + field.name.back() : field.name, field.type);
    }
  }

  //! compares the number of points with the size of the file
  void check_size() const
  {
    std::uint64_t least = m_layout.row_size; // bytes per point
    if (m_header.encoding == Pcd_encoding::ascii) {
      least = 0;
      for (const Pcd_field& field : m_header.fields)
        least += 2 * field.count;
    }
    std::uint64_t most = m_file.remaining() + 1;
    if (m_header.encoding == Pcd_encoding::compressed)
      most *= largest_lzf_ratio;
    if (m_header.number_of_points > most / least)
      m_file.fail_at_line("the file is too small for " + std::to_string(m_header.number_of_points) +
                          " points; it may be incomplete, copy it again");
  }

  //! reads all points of a compressed file, stored field by field
  void decompress()
  {
    std::array<unsigned char, 8> sizes{};
    const std::uint64_t at = m_file.position();
    m_file.read(sizes.data(), sizes.size());
    const auto compressed = load_little<std::uint32_t>(sizes, 0);
    const auto size = load_little<std::uint32_t>(sizes, 4);
    if (size != m_header.number_of_points * m_layout.row_size)
      m_file.fail_at_byte(at + 4,
                          "expected " + std::to_string(m_header.number_of_points) + " points of " +
                              std::to_string(m_layout.row_size) + " bytes, found " +
                              std::to_string(size) + " bytes");
    if (compressed > m_file.remaining())
      m_file.fail_at_end();
    std::vector<unsigned char> from(compressed);
    m_file.read(from.data(), from.size());
    m_data.resize(size);
    if (!decompress_lzf(from, m_data))
      m_file.fail_at_byte(at, "the compressed data are damaged; copy the file again");
  }

  //! reads a point and returns its line or byte
  std::uint64_t read_row(unsigned char* to)
  {
    const std::uint64_t at = m_file.position();
    if (m_header.encoding == Pcd_encoding::ascii) {
      parse_row(to);
      return m_file.line_number();
    }
    if (m_header.encoding == Pcd_encoding::binary) {
      m_file.read(to, m_layout.row_size);
      return at;
    }
    const auto i = static_cast<std::size_t>(m_header.number_of_points - m_rows_left);
    const unsigned char* from = m_data.data();
    for (const Pcd_field& field : m_header.fields) {
      std::memcpy(to, from + i * field.size(), field.size());
      from += static_cast<std::size_t>(m_header.number_of_points) * field.size();
      to += field.size();
    }
    return at;
  }

  void parse_row(unsigned char* to)
  {
    std::string_view line;
    do
      if (!m_file.read_line(line))
        m_file.fail_at_end();
    while (trim(line).empty());
    for (const Pcd_field& field : m_header.fields)
      for (std::size_t i = 0; i < field.count; ++i, to += size_of(field.type)) {
        const std::string_view word = next_word(line);
        const bool is_bit_pattern = is_packed_color(field) && // or the same bits as a float
                                    word.find_first_not_of("0123456789") == std::string_view::npos;
        const Scalar_type type = is_bit_pattern ? Scalar_type::uint32 : field.type;
        const Parse_result result = parse_to_bytes(word, type, to);
        if (result != Parse_result::ok)
          m_file.fail_at_line(number_expected(word, field.name, type, result));
        if (is_packed_color(field) && is_big_endian_machine())
          std::reverse(to, to + 4);
      }
    if (!trim(line).empty())
      m_file.fail_at_line("expected the end of the line, found " + in_quotes(trim(line)));
  }

  bool is_without_return(const unsigned char* row) const
  {
    for (const Field& field : m_layout.fields) {
      if (!is_coordinate_name(field.name))
        continue;
      const bool is_nan = dispatch(field.type, [&](auto tag) {
        using T = typename decltype(tag)::type;
        return std::isnan(static_cast<double>(load<T>(row + field.offset, m_layout.do_swap())));
      });
      if (is_nan)
        return true;
    }
    return false;
  }

  void check_end()
  {
    if (m_header.encoding == Pcd_encoding::ascii)
      expect_end_of_text(m_file);
    else if (m_file.remaining() > 0)
      m_file.fail_at_byte(m_file.position(),
                          "expected the end of the file, found " +
                              std::to_string(m_file.remaining()) + " more bytes");
  }

  Input_file m_file;
  Pcd_header m_header;
  std::vector<unsigned char> m_data; // of a compressed file
  std::uint64_t m_rows_left = 0;
};

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_SCANS_PCD_READER_H
