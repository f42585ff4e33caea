// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Reads the compressed points of a LAZ file, if pcs is built with LASzip.

#ifndef PCS_IO_INTERNAL_LAS_LAZ_READER_H
#define PCS_IO_INTERNAL_LAS_LAZ_READER_H

#include <pcs/IO/internal/Input_file.h>
#include <pcs/IO/internal/las/Las_reader.h>
#include <pcs/IO/internal/las/laszip_point.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace pcs {
namespace IO {
namespace internal {

//! returns an instruction for messages: how to read a LAZ file, or convert it to LAS
inline std::string laz_conversions()
{
  return "build pcs with LASzip (package liblaszip-dev where there is one, CMake variable "
         "PCS_WITH_LASZIP), or convert "
         "the file: laszip -i a.laz -o a.las, las2las -i a.laz -o a.las, or pdal translate a.laz "
         "a.las";
}

//! whether the header of a LAS file marks its points as compressed; throws if the file is also
//! compressed by gzip, because LASzip reads from the file itself
inline bool has_compressed_points(const std::string& path)
{
  Input_file file(path);
  std::array<unsigned char, las_header::point_format + 1> head{};
  const bool is_compressed = file.read_at_most(head.data(), head.size()) == head.size() &&
                             head.back() >= las_header::compressed_bit;
  if (is_compressed && file.is_compressed())
    throw IO_error(path,
                   "a LAZ file inside a gzip file is not read; unpack the file: gunzip -k FILE");
  return is_compressed;
}

#ifdef PCS_WITH_LASZIP

/*
  Reads header, variable-length records and counts like those of a LAS file. The record that
  describes the compression is removed, so that the points can be written to a LAS file. LASzip does
  not detect all damage: damaged data may be read as wrong points.
*/
class Laz_reader : public Las_reader
{
public:
  explicit Laz_reader(const std::string& path) : Las_reader(path, true)
  {
    remove_laszip_vlr();
    laszip_BOOL is_compressed = 0;
    if (laszip_create(&m_laszip.handle) != 0)
      throw IO_error(path, "LASzip cannot be started");
    check(laszip_open_reader(m_laszip.handle, path.c_str(), &is_compressed));
    check(laszip_get_point_pointer(m_laszip.handle, &m_point));
    m_format = m_las->header[las_header::point_format];
    const std::size_t core = las_point_layout(m_format).row_size;
    m_number_of_extra_bytes = m_layout.row_size - core;
    if (m_number_of_extra_bytes > 0 &&
        (m_point->num_extra_bytes < 0 ||
         static_cast<std::size_t>(m_point->num_extra_bytes) != m_number_of_extra_bytes))
      m_file.fail_at_byte(las_header::record_length,
                          "the point records differ from those that LASzip compressed");
  }

  void read_rows(Row_block& block, std::size_t max_rows) override
  {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(max_rows, m_rows_left));
    start_block(block, n);
    for (; block.number_of_rows < n; ++block.number_of_rows) {
      check(laszip_read_point(m_laszip.handle));
      Record_writer record(block.bytes.data() + block.number_of_rows * m_layout.row_size);
      put_record(*m_point, m_format, record);
      record.put_bytes(m_point->extra_bytes, m_number_of_extra_bytes);
      block.locations.push_back(*m_number_of_points - m_rows_left);
      --m_rows_left;
    }
  }

  [[noreturn]] void fail_at(std::uint64_t location, const std::string& what) const override
  {
    throw IO_error(m_file.path(), "record " + std::to_string(location) + ": " + what);
  }

  std::uint64_t largest_plausible_count() const override { return m_file.size(); }

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
      laszip_close_reader(handle);
      laszip_destroy(handle);
    }
    laszip_POINTER handle = nullptr;
  };

  void check(laszip_I32 result) const
  {
    if (result == 0)
      return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(m_laszip.handle, &message);
    throw IO_error(m_file.path(),
                   "point " + std::to_string(*m_number_of_points - m_rows_left) + " of " +
                       std::to_string(*m_number_of_points) + " cannot be decompressed: " +
                       (message != nullptr ? message : "unknown error of LASzip") +
                       "; the file may be incomplete, copy it again");
  }

  void remove_laszip_vlr()
  {
    constexpr std::uint16_t laszip_id = 22204;
    const auto n = load_little<std::uint32_t>(m_las->header, las_header::number_of_vlrs);
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::size_t size =
          vlr_header_size + load_little<std::uint16_t>(m_las->vlrs, at + las_vlr::length);
      if (load_little<std::uint16_t>(m_las->vlrs, at + las_vlr::record_id) == laszip_id &&
          std::memcmp(m_las->vlrs.data() + at + las_vlr::user_id, "laszip encoded", 15) == 0) {
        const auto first = m_las->vlrs.begin() + static_cast<std::ptrdiff_t>(at);
        m_las->vlrs.erase(first, first + static_cast<std::ptrdiff_t>(size));
        store_little<std::uint32_t>(m_las->header, las_header::number_of_vlrs, n - 1);
        return;
      }
      at += size;
    }
    m_file.fail_at_byte(las_header::point_format,
                        "the points are marked as compressed, but there is no record of LASzip");
  }

  Handle m_laszip;
  laszip_point_struct* m_point = nullptr;
  unsigned m_format = 0;
  std::size_t m_number_of_extra_bytes = 0;
};

#endif // PCS_WITH_LASZIP

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_LAS_LAZ_READER_H
