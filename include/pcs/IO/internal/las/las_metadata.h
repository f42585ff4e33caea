// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Header, extra bytes descriptors and integer grid of a LAS file to be written.

#ifndef PCS_IO_INTERNAL_LAS_LAS_METADATA_H
#define PCS_IO_INTERNAL_LAS_LAS_METADATA_H

#include <pcs/IO/internal/las/las_layout.h>
#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Write_options.h>
#include <pcs/core/errors.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <unordered_set>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

//! makes a LAS 1.4 header for points that are not from a LAS file
inline Las_metadata make_las_metadata(const Point_schema& schema)
{
  const auto is_16_bit = [&](const char* name) {
    const std::size_t i = schema.find(name);
    return i < schema.properties.size() && schema.properties[i].type == Scalar_type::uint16;
  };
  const unsigned format = is_16_bit("red") && is_16_bit("green") && is_16_bit("blue") ? 7 : 6;
  Las_metadata las;
  las.header.assign(las_header::size_1_4, 0);
  std::memcpy(las.header.data(), "LASF", 4);
  std::memcpy(las.header.data() + las_header::generating_software, "pcs", 3);
  las.header[las_header::version_major] = 1;
  las.header[las_header::version_minor] = 4;
  las.header[las_header::point_format] = static_cast<unsigned char>(format);
  // point formats from 6 on must declare coordinate systems as WKT
  store_little<std::uint16_t>(las.header, las_header::global_encoding, 16);
  store_little(las.header,
               las_header::header_size,
               static_cast<std::uint16_t>(las_header::size_1_4));
  store_little(las.header,
               las_header::record_length,
               static_cast<std::uint16_t>(las_point_layout(format).row_size));
  return las;
}

//! appends a descriptor; type 0 denotes `size` bytes without interpretation
inline void append_descriptor(std::vector<unsigned char>& to,
                              const std::string& name,
                              unsigned type,
                              std::size_t size)
{
  to.resize(to.size() + extra_bytes_descriptor_size, 0);
  unsigned char* descriptor = to.data() + to.size() - extra_bytes_descriptor_size;
  descriptor[2] = static_cast<unsigned char>(type);
  descriptor[3] = static_cast<unsigned char>(type == 0 ? size : 0);
  std::memcpy(descriptor + 4, name.data(), name.size());
}

inline unsigned extra_bytes_type(Scalar_type type)
{
  const auto hit = std::find(extra_bytes_types.begin(), extra_bytes_types.end(), type);
  return static_cast<unsigned>(hit - extra_bytes_types.begin()) + 1;
}

//! inserts descriptors at the end of the extra bytes VLR, which is created if it is missing;
//! returns an error message, or an empty string
inline std::string insert_descriptors(Las_metadata& las, const std::vector<unsigned char>& added)
{
  std::size_t at = find_extra_bytes_vlr(las).value_or(las.vlrs.size());
  const bool is_new = at == las.vlrs.size();
  if (is_new) {
    const auto n = load_little<std::uint32_t>(las.header, las_header::number_of_vlrs);
    at = 0; // before the other VLRs, which may be followed by padding
    std::vector<unsigned char> vlr(vlr_header_size, 0);
    std::memcpy(vlr.data() + las_vlr::user_id, "LASF_Spec", 9);
    std::memcpy(vlr.data() + las_vlr::description, "Extra bytes", 11);
    store_little<std::uint16_t>(vlr, las_vlr::record_id, las_vlr::extra_bytes_id);
    las.vlrs.insert(las.vlrs.begin(), vlr.begin(), vlr.end());
    store_little<std::uint32_t>(las.header, las_header::number_of_vlrs, n + 1);
  }
  const std::size_t length = load_little<std::uint16_t>(las.vlrs, at + las_vlr::length);
  if (length + added.size() > std::numeric_limits<std::uint16_t>::max())
    return "there are too many properties for LAS";
  const auto end = static_cast<std::ptrdiff_t>(at + vlr_header_size + length);
  las.vlrs.insert(las.vlrs.begin() + end, added.begin(), added.end());
  store_little(las.vlrs, at + las_vlr::length, static_cast<std::uint16_t>(length + added.size()));
  return {};
}

/*!
  Adds the missing properties to the records. Returns an error message, or an empty string.
*/
inline std::string add_extra_dimensions(Las_metadata& las, const Point_schema& schema)
{
  const Row_layout old = las_record_layout(las);
  std::unordered_set<std::string> known;
  for (const Field& field : old.fields)
    known.insert(field.name);
  std::vector<unsigned char> added;
  std::size_t record_length = old.row_size;
  // descriptors are counted from the first extra byte, so all extra bytes require one
  std::size_t described = las_point_layout(las.header[las_header::point_format]).row_size;
  for (const Extra_dimension& extra : extra_dimensions(las))
    described += extra.size;
  for (const Property_description& p : schema.properties) {
    if (known.count(p.name) != 0)
      continue;
    if (described > old.row_size)
      return "the extra bytes of the file are described wrongly, '" + p.name + "' cannot be added";
    for (; described < old.row_size;
         described += std::min<std::size_t>(255, old.row_size - described))
      append_descriptor(added, "", 0, std::min<std::size_t>(255, old.row_size - described));
    if (p.name.size() > 32)
      return "LAS cannot hold the property name '" + p.name + "' of more than 32 characters";
    append_descriptor(added, p.name, extra_bytes_type(p.type), 0);
    record_length += size_of(p.type);
  }
  if (record_length > std::numeric_limits<std::uint16_t>::max())
    return "there are too many properties for LAS";
  store_little(las.header, las_header::record_length, static_cast<std::uint16_t>(record_length));
  return added.empty() ? std::string() : insert_descriptors(las, added);
}

//! returns the smallest and the largest coordinate along an axis
inline std::array<double, 2> range_of(const Point_table& table, int axis)
{
  std::array<double, 2> range = {0, 0};
  for (std::size_t i = 0; i < table.number_of_points(); ++i) {
    const double value = table.points()[i][axis];
    range[0] = i == 0 ? value : std::min(range[0], value);
    range[1] = i == 0 ? value : std::max(range[1], value);
  }
  return range;
}

inline bool fits_grid(const std::array<double, 2>& range, double scale, double offset)
{
  for (const double value : range) {
    const double step = quantize(value, scale, offset);
    if (!(step >= INT32_MIN && step <= INT32_MAX))
      return false;
  }
  return true;
}

/*!
  Sets scale and offset if the caller did not. Points from LAS keep their scale. They also keep
  their offset if their coordinates can be represented with it. For other points, the scale is the
  finest power of ten that gives at most 5e8 steps along the longest side of the bounding box (four
  times as many would exhaust the integers). The offset is the lower corner of the box, rounded down
  to a multiple of the largest power of ten within this side. If coordinates cannot be represented
  with an offset, it is replaced by the rounded center of the box.
*/
inline void
choose_las_grid(const std::string& path, const Point_table& table, Write_options& options)
{
  const Las_metadata* las = table.schema().las.get();
  std::array<std::array<double, 2>, 3> box;
  double extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box[axis] = range_of(table, static_cast<int>(axis));
    extent = std::max(extent, box[axis][1] - box[axis][0]);
  }
  if (!std::isfinite(extent))
    throw IO_error(path, "the points are too far apart for LAS");
  if (extent == 0)
    extent = 1;
  std::array<double, 3> scale{}, offset{};
  const double unit = std::pow(10.0, std::floor(std::log10(extent)));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = box[axis][0];
    scale[axis] = options.las_scale ? (*options.las_scale)[axis]
                  : las != nullptr  ? las->scale[axis]
                                    : std::pow(10.0, std::ceil(std::log10(extent / 5e8)));
    offset[axis] = options.las_offset ? (*options.las_offset)[axis]
                   : las != nullptr   ? las->offset[axis]
                                      : std::floor(low / unit) * unit;
    if (!options.las_offset && !fits_grid(box[axis], scale[axis], offset[axis]))
      offset[axis] = std::round(0.5 * low + 0.5 * box[axis][1]);
    if (!fits_grid(box[axis], scale[axis], offset[axis]))
      throw IO_error(path,
                     std::string("coordinate ") + static_cast<char>('x' + axis) +
                         " does not fit into the 32 bits of LAS with scale " +
                         std::to_string(scale[axis]) + " and offset " +
                         std::to_string(offset[axis]));
  }
  options.las_scale = scale;
  options.las_offset = offset;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_LAS_LAS_METADATA_H
