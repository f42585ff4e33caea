// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Converts between the point of LASzip and the bytes of a LAS point record.

#ifndef PCS_IO_INTERNAL_LAS_LASZIP_POINT_H
#define PCS_IO_INTERNAL_LAS_LASZIP_POINT_H

#ifdef PCS_WITH_LASZIP

#include <pcs/IO/internal/las/las_layout.h>
#include <pcs/IO/internal/numbers.h>

#if __has_include(<laszip/laszip_api.h>)
#include <laszip/laszip_api.h>
#else
#include <laszip_api.h>
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pcs {
namespace IO {
namespace internal {

//! appends values to a little endian record
class Record_writer
{
public:
  explicit Record_writer(unsigned char* to) : m_to(to) {}

  template <class T>
  void put(T value)
  {
    store(value, m_to, is_big_endian_machine());
    m_to += sizeof value;
  }
  void put_byte(unsigned value) { put(static_cast<std::uint8_t>(value)); }
  void put_bytes(const unsigned char* bytes, std::size_t n)
  {
    if (n > 0)
      std::memcpy(m_to, bytes, n);
    m_to += n;
  }

private:
  unsigned char* m_to;
};

//! takes values from a little endian record
class Record_reader
{
public:
  explicit Record_reader(const unsigned char* from) : m_from(from) {}

  template <class T>
  void take(T& value)
  {
    value = load<T>(m_from, is_big_endian_machine());
    m_from += sizeof value;
  }
  unsigned take_byte() { return *m_from++; }
  void take_bytes(unsigned char* to, std::size_t n)
  {
    if (n > 0)
      std::memcpy(to, m_from, n);
    m_from += n;
  }

private:
  const unsigned char* m_from;
};

inline void put_core_0_to_5(Record_writer& record, const laszip_point_struct& p)
{
  record.put_byte(p.return_number | unsigned(p.number_of_returns) << 3 |
                  unsigned(p.scan_direction_flag) << 6 | unsigned(p.edge_of_flight_line) << 7);
  record.put_byte(p.classification | unsigned(p.synthetic_flag) << 5 |
                  unsigned(p.keypoint_flag) << 6 | unsigned(p.withheld_flag) << 7);
  record.put(p.scan_angle_rank);
  record.put(p.user_data);
  record.put(p.point_source_ID);
}

inline void put_core_6_to_10(Record_writer& record, const laszip_point_struct& p)
{
  record.put_byte(p.extended_return_number | unsigned(p.extended_number_of_returns) << 4);
  record.put_byte(p.extended_classification_flags | unsigned(p.extended_scanner_channel) << 4 |
                  unsigned(p.scan_direction_flag) << 6 | unsigned(p.edge_of_flight_line) << 7);
  record.put(p.extended_classification);
  record.put(p.user_data);
  record.put(p.extended_scan_angle);
  record.put(p.point_source_ID);
}

//! writes the record of a point without its extra bytes
inline void put_record(const laszip_point_struct& p, unsigned format, Record_writer& record)
{
  record.put(p.X);
  record.put(p.Y);
  record.put(p.Z);
  record.put(p.intensity);
  if (format < 6)
    put_core_0_to_5(record, p);
  else
    put_core_6_to_10(record, p);
  if (has_gps_time(format))
    record.put(p.gps_time);
  if (has_colors(format))
    for (std::size_t i = 0; i < 3; ++i)
      record.put(p.rgb[i]);
  if (has_near_infrared(format))
    record.put(p.rgb[3]);
  if (has_waveform(format))
    record.put_bytes(p.wave_packet, sizeof p.wave_packet);
}

inline void take_core_0_to_5(Record_reader& record, laszip_point_struct& p)
{
  const unsigned returns = record.take_byte();
  p.return_number = returns & 7u;
  p.number_of_returns = returns >> 3 & 7u;
  p.scan_direction_flag = returns >> 6 & 1u;
  p.edge_of_flight_line = returns >> 7 & 1u;
  const unsigned classes = record.take_byte();
  p.classification = classes & 31u;
  p.synthetic_flag = classes >> 5 & 1u;
  p.keypoint_flag = classes >> 6 & 1u;
  p.withheld_flag = classes >> 7 & 1u;
  record.take(p.scan_angle_rank);
  record.take(p.user_data);
  record.take(p.point_source_ID);
}

inline void take_core_6_to_10(Record_reader& record, laszip_point_struct& p)
{
  const unsigned returns = record.take_byte();
  p.extended_point_type = 1;
  p.extended_return_number = returns & 15u;
  p.extended_number_of_returns = returns >> 4 & 15u;
  const unsigned flags = record.take_byte();
  p.extended_classification_flags = flags & 15u;
  p.synthetic_flag = flags & 1u; // LASzip refuses points whose older flags differ
  p.keypoint_flag = flags >> 1 & 1u;
  p.withheld_flag = flags >> 2 & 1u;
  p.extended_scanner_channel = flags >> 4 & 3u;
  p.scan_direction_flag = flags >> 6 & 1u;
  p.edge_of_flight_line = flags >> 7 & 1u;
  record.take(p.extended_classification);
  record.take(p.user_data);
  record.take(p.extended_scan_angle);
  record.take(p.point_source_ID);
}

//! reads a point from its record without its extra bytes
inline void take_record(Record_reader& record, unsigned format, laszip_point_struct& p)
{
  record.take(p.X);
  record.take(p.Y);
  record.take(p.Z);
  record.take(p.intensity);
  if (format < 6)
    take_core_0_to_5(record, p);
  else
    take_core_6_to_10(record, p);
  if (has_gps_time(format))
    record.take(p.gps_time);
  if (has_colors(format))
    for (std::size_t i = 0; i < 3; ++i)
      record.take(p.rgb[i]);
  if (has_near_infrared(format))
    record.take(p.rgb[3]);
  if (has_waveform(format))
    record.take_bytes(p.wave_packet, sizeof p.wave_packet);
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_WITH_LASZIP

#endif // PCS_IO_INTERNAL_LAS_LASZIP_POINT_H
