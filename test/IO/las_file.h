// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Builds a LAS file byte by byte from the specification, independent of the reader.

#ifndef PCS_TEST_IO_LAS_FILE_H
#define PCS_TEST_IO_LAS_FILE_H

#include "temporary_files.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

//! Lengths of the point records 0 to 10 in the LAS 1.4 specification (R15), tables 7 to 17.
constexpr std::array<std::uint16_t, 11> las_record_lengths =
    {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct Las_file
{
  unsigned format = 0;
  unsigned minor = 2;
  std::size_t number_of_extra_bytes = 0;
  std::string vlrs;
  std::uint32_t number_of_vlrs = 0;
  std::string evlrs;
  std::uint32_t number_of_evlrs = 0;

  std::size_t header_size() const { return minor < 3 ? 227 : minor == 3 ? 235 : 375; }
  std::size_t record_length() const { return las_record_lengths[format] + number_of_extra_bytes; }

  //! Three points; byte k after the coordinates in the record of point i is (i + 1) * (k + 1).
  std::string bytes() const
  {
    const std::size_t first_point = header_size() + vlrs.size();
    std::string result(header_size(), '\0');
    result.replace(0, 4, "LASF");
    result.replace(26, 4, "test");
    patch<std::uint8_t>(result, 24, 1);
    patch(result, 25, static_cast<std::uint8_t>(minor));
    patch(result, 94, static_cast<std::uint16_t>(header_size()));
    patch(result, 96, static_cast<std::uint32_t>(first_point));
    patch(result, 100, number_of_vlrs);
    patch(result, 104, static_cast<std::uint8_t>(format));
    patch(result, 105, static_cast<std::uint16_t>(record_length()));
    patch<std::uint32_t>(result, 107, format < 6 ? 3 : 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      patch(result, 131 + 8 * axis, 0.001);
      patch(result, 155 + 8 * axis, axis == 1 ? 5000000.0 : 500000.0);
    }
    if (minor >= 4) {
      patch<std::uint64_t>(result, 247, 3);
      patch(result, 243, number_of_evlrs);
      if (number_of_evlrs > 0)
        patch<std::uint64_t>(result, 235, first_point + 3 * record_length());
    }
    result += vlrs;
    for (std::int32_t i = 0; i < 3; ++i) {
      for (const std::int32_t value : {123 + i, 456 + i, -789 + i})
        put(result, value);
      for (std::size_t k = 12; k < record_length(); ++k)
        result += static_cast<char>((static_cast<std::size_t>(i) + 1) * (k - 11));
    }
    return result + evlrs;
  }

  void add_vlr(const std::string& user, std::uint16_t id, const std::string& data)
  {
    put<std::uint16_t>(vlrs, 0);
    vlrs += user + std::string(16 - user.size(), '\0');
    put(vlrs, id);
    put(vlrs, static_cast<std::uint16_t>(data.size()));
    vlrs += std::string(32, '\0') + data;
    ++number_of_vlrs;
  }

  void add_evlr(const std::string& user, std::uint16_t id, const std::string& data)
  {
    put<std::uint16_t>(evlrs, 0);
    evlrs += user + std::string(16 - user.size(), '\0');
    put(evlrs, id);
    put(evlrs, static_cast<std::uint64_t>(data.size()));
    evlrs += std::string(32, '\0') + data;
    ++number_of_evlrs;
  }
};

//! A descriptor of one extra dimension.
inline std::string
extra_bytes_descriptor(const std::string& name, std::uint8_t type, std::uint8_t options = 0)
{
  std::string result(192, '\0');
  patch(result, 2, type);
  patch(result, 3, options);
  return result.replace(4, name.size(), name);
}

#endif // PCS_TEST_IO_LAS_FILE_H
