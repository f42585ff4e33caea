// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Packed rows of values, the intermediate form between a file and the columns of a Point_table.

#ifndef PCS_IO_INTERNAL_ROW_BLOCK_H
#define PCS_IO_INTERNAL_ROW_BLOCK_H

#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Scalar_type.h>
#include <pcs/core/errors.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

//! the position of a value in a row; several values of less than 8 bits may be in one byte
struct Field
{
  std::string name;
  Scalar_type type = Scalar_type::float64;
  std::size_t offset = 0;
  unsigned shift = 0;
  unsigned number_of_bits = 0; // 0: the whole value
};

struct Row_layout
{
  std::vector<Field> fields;
  std::size_t row_size = 0;
  bool is_big_endian = is_big_endian_machine();
  // position = scale * stored value + offset; used by LAS, otherwise the identity
  std::array<double, 3> scale = {1, 1, 1};
  std::array<double, 3> offset = {0, 0, 0};
  bool is_scaled = false;

  bool do_swap() const { return is_big_endian != is_big_endian_machine(); }

  //! appends a value to the layout
  void push_back(const std::string& name, Scalar_type type)
  {
    fields.push_back({name, type, row_size});
    row_size += size_of(type);
  }
};

//! approximate number of bytes that are processed at a time
constexpr std::size_t block_size = std::size_t(1) << 16;

inline std::size_t rows_per_block(const Row_layout& layout)
{
  const std::size_t n = block_size / (layout.row_size + 1);
  return n > 0 ? n : 1;
}

//! a block of rows with the line (text) or byte (binary) of each row in the file
struct Row_block
{
  std::vector<unsigned char> bytes;
  std::vector<std::uint64_t> locations;
  std::size_t number_of_rows = 0;
};

// ---- from rows to columns ----

template <class T>
void decode_field(const Row_block& block,
                  const Row_layout& layout,
                  const Field& field,
                  std::vector<T>& values)
{
  const unsigned char* row = block.bytes.data() + field.offset;
  const bool do_swap = layout.do_swap();
  const std::size_t begin = values.size();
  values.resize(begin + block.number_of_rows);
  for (std::size_t i = 0; i < block.number_of_rows; ++i, row += layout.row_size)
    values[begin + i] = load<T>(row, do_swap);
  if (field.number_of_bits == 0)
    return;
  const unsigned mask = (1u << field.number_of_bits) - 1u;
  for (std::size_t i = begin; i < values.size(); ++i)
    values[i] = static_cast<T>((static_cast<unsigned>(values[i]) >> field.shift) & mask);
}

inline std::vector<double>
decode_coordinate(const Row_block& block, const Row_layout& layout, const Field& field)
{
  std::vector<double> result;
  result.reserve(block.number_of_rows);
  dispatch(field.type, [&](auto tag) {
    std::vector<typename decltype(tag)::type> values;
    decode_field(block, layout, field, values);
    for (const auto value : values)
      result.push_back(static_cast<double>(value));
  });
  if (layout.is_scaled) {
    const auto axis = static_cast<std::size_t>(field.name[0] - 'x');
    for (double& value : result)
      value = value * layout.scale[axis] + layout.offset[axis];
  }
  return result;
}

/*!
  Appends the rows to the table, whose properties are the fields of the layout.
  `fail(row, message)` is called for the first row with a coordinate that is not finite.
*/
template <class Fail>
void append_rows(const Row_block& block, const Row_layout& layout, Point_table& table, Fail&& fail)
{
  std::array<std::vector<double>, 3> xyz;
  for (std::size_t c = 0; c < layout.fields.size(); ++c) {
    const Field& field = layout.fields[c];
    if (is_coordinate_name(field.name))
      xyz[static_cast<std::size_t>(field.name[0] - 'x')] = decode_coordinate(block, layout, field);
    else
      std::visit([&](auto& values) { decode_field(block, layout, field, values); },
                 table.values_at(c));
  }
  for (std::size_t i = 0; i < block.number_of_rows; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!std::isfinite(xyz[axis][i]))
        fail(i,
             std::string("expected a finite number as coordinate ") +
                 static_cast<char>('x' + axis));
    table.points().emplace_back(xyz[0][i], xyz[1][i], xyz[2][i]);
  }
}

// ---- from columns to rows ----

//! converts without loss, except that a double may be rounded to a float
template <class To, class From>
bool convert(From from, To& to)
{
  if constexpr (std::is_same_v<To, From>) {
    to = from;
    return true;
  } else if constexpr (std::is_same_v<To, double>) {
    to = static_cast<double>(from);
    if constexpr (std::is_integral_v<From> && sizeof(From) == 8) // integers up to 2^53 are exact
      return from <= From(1) << 53 && (from >= From(0) || from >= -(From(1) << 53));
    return true;
  } else if constexpr (std::is_same_v<To, float>) {
    const auto wide = static_cast<double>(from);
    if (std::isfinite(wide) && std::abs(wide) > double(std::numeric_limits<float>::max()))
      return false;
    to = static_cast<float>(wide);
    return true;
  } else if constexpr (std::is_floating_point_v<From>) {
    const auto wide = static_cast<double>(from);
    const double end = std::ldexp(1.0, std::numeric_limits<To>::digits);
    if (!(wide >= static_cast<double>(std::numeric_limits<To>::min()) && wide < end) ||
        wide != std::floor(wide))
      return false;
    to = static_cast<To>(wide);
    return true;
  } else {
    to = static_cast<To>(from);
    return static_cast<From>(to) == from && (to < To(0)) == (from < From(0));
  }
}

template <class From, class Get>
void encode_field(std::size_t n,
                  const Row_layout& layout,
                  const Field& field,
                  Get&& get,
                  std::size_t first_point,
                  Row_block& block)
{
  const bool do_swap = layout.do_swap();
  dispatch(field.type, [&](auto tag) {
    using To = typename decltype(tag)::type;
    unsigned char* row = block.bytes.data() + field.offset;
    for (std::size_t i = 0; i < n; ++i, row += layout.row_size) {
      To value{};
      const From from = get(i);
      bool ok = convert(from, value);
      if (field.number_of_bits != 0) {
        const auto bits = static_cast<unsigned>(value);
        ok = ok && bits < (1u << field.number_of_bits);
        value = static_cast<To>(static_cast<unsigned>(*row) | (bits << field.shift));
      }
      if (!ok)
        throw Invalid_input("pcs::IO: '" + field.name + "' of point " +
                            std::to_string(first_point + i) + " does not fit into " +
                            (field.number_of_bits != 0
                                 ? std::to_string(field.number_of_bits) + " bits"
                                 : std::string(name_of(field.type))));
      store(value, row, do_swap);
    }
  });
}

//! returns the integer that encodes a coordinate, as a double; the caller checks the range
inline double quantize(double value, double scale, double offset)
{
  return std::round((value - offset) / scale);
}

/*!
  Packs the points `[first, first + n)` of the table into rows. Fields without a property of the
  same name in the table are set to zero. `columns` is the result of `find_columns()`.
*/
inline void pack_rows(const Point_table& table,
                      const std::vector<std::size_t>& columns,
                      std::size_t first,
                      std::size_t n,
                      const Row_layout& layout,
                      Row_block& block)
{
  block.number_of_rows = n;
  block.bytes.assign(n * layout.row_size, 0);
  for (std::size_t f = 0; f < layout.fields.size(); ++f) {
    const Field& field = layout.fields[f];
    if (is_coordinate_name(field.name)) {
      const int axis = field.name[0] - 'x';
      const auto a = static_cast<std::size_t>(axis);
      const auto get = [&](std::size_t i) {
        const double value = table.points()[first + i][axis];
        return layout.is_scaled ? quantize(value, layout.scale[a], layout.offset[a]) : value;
      };
      encode_field<double>(n, layout, field, get, first, block);
    } else if (columns[f] < table.schema().properties.size()) {
      std::visit(
          [&](const auto& values) {
            using From = typename std::decay_t<decltype(values)>::value_type;
            const auto get = [&](std::size_t i) { return values[first + i]; };
            encode_field<From>(n, layout, field, get, first, block);
          },
          table.values_at(columns[f]));
    }
  }
}

//! returns for every field the index of the property with its name
inline std::vector<std::size_t> find_columns(const Point_schema& schema, const Row_layout& layout)
{
  std::vector<std::size_t> columns;
  for (const Field& field : layout.fields)
    columns.push_back(schema.find(field.name));
  return columns;
}

//! throws unless all coordinates are finite
inline void check_finite(const Point_table& table)
{
  for (std::size_t i = 0; i < table.number_of_points(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(table.points()[i][axis]))
        throw Invalid_input("pcs::IO: coordinate " + std::string(1, static_cast<char>('x' + axis)) +
                            " of point " + std::to_string(i) + " is not finite");
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_ROW_BLOCK_H
