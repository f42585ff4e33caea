// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Layout of LAS files: positions in the header, dimensions of a point record, extra bytes.

#ifndef PCS_IO_INTERNAL_LAS_LAS_LAYOUT_H
#define PCS_IO_INTERNAL_LAS_LAS_LAYOUT_H

#include <pcs/IO/internal/Row_block.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Point_schema.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

//! positions in the public header block [byte]
namespace las_header {
constexpr std::size_t global_encoding = 6, version_major = 24, version_minor = 25,
                      generating_software = 58, header_size = 94, offset_to_points = 96,
                      number_of_vlrs = 100, point_format = 104, record_length = 105,
                      legacy_count = 107, legacy_by_return = 111, scale = 131, offset = 155,
                      box = 179, waveforms = 227, first_evlr = 235, number_of_evlrs = 243,
                      count = 247, by_return = 255;
constexpr unsigned compressed_bit = 128; // of the point format, in LAZ files
constexpr std::size_t size_1_2 = 227, size_1_3 = 235, size_1_4 = 375;
} // namespace las_header

constexpr std::size_t vlr_header_size = 54;
constexpr std::size_t evlr_header_size = 60;
constexpr std::size_t extra_bytes_descriptor_size = 192;
constexpr unsigned largest_point_format = 10;

//! positions in the header of a variable length record [byte]
namespace las_vlr {
constexpr std::size_t user_id = 2, record_id = 18, length = 20, description = 22;
constexpr std::uint16_t extra_bytes_id = 4;
} // namespace las_vlr

inline bool has_colors(unsigned format)
{
  return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}
inline bool has_gps_time(unsigned format)
{
  return format == 1 || format >= 3;
}
inline bool has_near_infrared(unsigned format)
{
  return format == 8 || format == 10;
}
inline bool has_waveform(unsigned format)
{
  return format == 4 || format == 5 || format == 9 || format == 10;
}

//! adds values that share one byte, given by name and number of bits, lowest bits first
inline void add_bits(Row_layout& layout,
                     std::initializer_list<std::pair<const char*, unsigned>> bits)
{
  unsigned shift = 0;
  for (const auto& [name, number_of_bits] : bits) {
    layout.fields.push_back({name, Scalar_type::uint8, layout.row_size, shift, number_of_bits});
    shift += number_of_bits;
  }
  layout.row_size += 1;
}

inline void add_point_core_0_to_5(Row_layout& layout)
{
  add_bits(layout,
           {{"return_number", 3},
            {"number_of_returns", 3},
            {"scan_direction_flag", 1},
            {"edge_of_flight_line", 1}});
  add_bits(layout, {{"classification", 5}, {"synthetic", 1}, {"key_point", 1}, {"withheld", 1}});
  layout.push_back("scan_angle_rank", Scalar_type::int8);
  layout.push_back("user_data", Scalar_type::uint8);
  layout.push_back("point_source_id", Scalar_type::uint16);
}

inline void add_point_core_6_to_10(Row_layout& layout)
{
  add_bits(layout, {{"return_number", 4}, {"number_of_returns", 4}});
  add_bits(layout,
           {{"synthetic", 1},
            {"key_point", 1},
            {"withheld", 1},
            {"overlap", 1},
            {"scanner_channel", 2},
            {"scan_direction_flag", 1},
            {"edge_of_flight_line", 1}});
  layout.push_back("classification", Scalar_type::uint8);
  layout.push_back("user_data", Scalar_type::uint8);
  layout.push_back("scan_angle", Scalar_type::int16);
  layout.push_back("point_source_id", Scalar_type::uint16);
}

//! returns the dimensions of a point format, without extra bytes
inline Row_layout las_point_layout(unsigned format)
{
  Row_layout layout;
  layout.is_big_endian = false;
  layout.is_scaled = true;
  for (const char* name : {"x", "y", "z"})
    layout.push_back(name, Scalar_type::int32);
  layout.push_back("intensity", Scalar_type::uint16);
  if (format < 6)
    add_point_core_0_to_5(layout);
  else
    add_point_core_6_to_10(layout);
  if (has_gps_time(format))
    layout.push_back("gps_time", Scalar_type::float64);
  if (has_colors(format))
    for (const char* name : {"red", "green", "blue"})
      layout.push_back(name, Scalar_type::uint16);
  if (has_near_infrared(format))
    layout.push_back("near_infrared", Scalar_type::uint16);
  if (has_waveform(format)) {
    layout.push_back("wave_packet_index", Scalar_type::uint8);
    layout.push_back("wave_packet_offset", Scalar_type::uint64);
    layout.push_back("wave_packet_size", Scalar_type::uint32);
    for (const char* name : {"wave_location", "wave_x_t", "wave_y_t", "wave_z_t"})
      layout.push_back(name, Scalar_type::float32);
  }
  return layout;
}

//! returns the position of the extra bytes VLR in a block of VLRs, or no value
inline std::optional<std::size_t> find_extra_bytes_vlr(const Las_metadata& las)
{
  const auto n = load_little<std::uint32_t>(las.header, las_header::number_of_vlrs);
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < n && at + vlr_header_size <= las.vlrs.size(); ++i) {
    const unsigned char* user = las.vlrs.data() + at + las_vlr::user_id;
    if (std::memcmp(user, "LASF_Spec\0", 10) == 0 &&
        load_little<std::uint16_t>(las.vlrs, at + las_vlr::record_id) == las_vlr::extra_bytes_id)
      return at;
    at += vlr_header_size + load_little<std::uint16_t>(las.vlrs, at + las_vlr::length);
  }
  return std::nullopt;
}

//! the types 1 to 10 of an extra bytes descriptor
constexpr std::array<Scalar_type, 10> extra_bytes_types = {Scalar_type::uint8,
                                                           Scalar_type::int8,
                                                           Scalar_type::uint16,
                                                           Scalar_type::int16,
                                                           Scalar_type::uint32,
                                                           Scalar_type::int32,
                                                           Scalar_type::uint64,
                                                           Scalar_type::int64,
                                                           Scalar_type::float32,
                                                           Scalar_type::float64};

//! one descriptor: `size` bytes, with a type if they represent a single number
struct Extra_dimension
{
  std::string name;
  std::size_t size = 0;
  std::optional<Scalar_type> type;
};

inline Extra_dimension parse_extra_dimension(const unsigned char* descriptor)
{
  Extra_dimension result;
  const unsigned type = descriptor[2];
  if (type == 0) {
    result.size = descriptor[3];
  } else if (type <= 30) {
    // 11 to 20 are pairs and 21 to 30 triples of the types 1 to 10, stored as bytes
    const Scalar_type scalar = extra_bytes_types[(type - 1) % 10];
    result.size = size_of(scalar) * ((type - 1) / 10 + 1);
    if (type <= 10)
      result.type = scalar;
  }
  for (std::size_t i = 4; i < 36 && descriptor[i] != 0; ++i) {
    const auto c = static_cast<char>(descriptor[i]);
    // other formats separate names by blanks
    result.name += (c > ' ' && c <= '~' && c != ',' && c != ';' && c != '"') ? c : '_';
  }
  return result;
}

inline std::vector<Extra_dimension> extra_dimensions(const Las_metadata& las)
{
  std::vector<Extra_dimension> result;
  const std::optional<std::size_t> at = find_extra_bytes_vlr(las);
  if (!at)
    return result;
  const std::size_t length = load_little<std::uint16_t>(las.vlrs, *at + las_vlr::length);
  for (std::size_t i = 0; i + extra_bytes_descriptor_size <= length;
       i += extra_bytes_descriptor_size)
    result.push_back(parse_extra_dimension(las.vlrs.data() + *at + vlr_header_size + i));
  return result;
}

/*!
  Returns the layout of the point records of a file. Extra bytes that a descriptor declares as a
  single number are columns of its name and type. Scale and offset of a descriptor are not applied,
  so that values remain as stored. All other extra bytes are columns extra_byte_0, extra_byte_1, ...
*/
inline Row_layout las_record_layout(const Las_metadata& las)
{
  Row_layout layout = las_point_layout(las.header[las_header::point_format]);
  layout.scale = las.scale;
  layout.offset = las.offset;
  const std::size_t first_extra = layout.row_size;
  const std::size_t end = load_little<std::uint16_t>(las.header, las_header::record_length);
  std::unordered_set<std::string> names;
  for (const Field& field : layout.fields)
    names.insert(field.name);
  const auto add_raw_bytes = [&](std::size_t n) {
    for (; n > 0; --n)
      layout.push_back("extra_byte_" + std::to_string(layout.row_size - first_extra),
                       Scalar_type::uint8);
  };
  for (const Extra_dimension& extra : extra_dimensions(las)) {
    if (extra.size == 0 || layout.row_size + extra.size > end)
      break; // the descriptors do not match these records
    const bool is_name_free = !extra.name.empty() && extra.name.rfind("extra_byte_", 0) != 0;
    if (extra.type && is_name_free && names.insert(extra.name).second)
      layout.push_back(extra.name, *extra.type);
    else
      add_raw_bytes(extra.size);
  }
  add_raw_bytes(end - layout.row_size);
  return layout;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_LAS_LAS_LAYOUT_H
