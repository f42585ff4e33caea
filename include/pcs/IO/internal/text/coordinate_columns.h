// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Finds the columns of a table that contain the coordinates, by their names.

#ifndef PCS_IO_INTERNAL_TEXT_COORDINATE_COLUMNS_H
#define PCS_IO_INTERNAL_TEXT_COORDINATE_COLUMNS_H

#include <pcs/IO/internal/numbers.h>
#include <pcs/IO/internal/text/table_words.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace pcs {
namespace IO {
namespace internal {

//! returns the lower-case letters and digits of a name, without a unit in brackets at its end
inline std::string plain_name(std::string_view name)
{
  name = without_quotes(name);
  const std::size_t unit = name.find_first_of("[(");
  if (unit != std::string_view::npos && unit > 0)
    name = name.substr(0, unit);
  std::string text;
  for (const char c : to_lower(name))
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      text += c;
  return text;
}

inline bool is_one_of(const std::string& name, std::initializer_list<const char*> names)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

//! whether a name, other than the letter alone, denotes the coordinate along an axis
inline bool is_coordinate_alias(const std::string& name, std::size_t axis)
{
  const std::string letter(1, static_cast<char>('x' + axis));
  for (const char* word :
       {"", "coord", "coords", "coordinate", "position", "pos", "cartesian", "utm"})
    if (name == letter + word || name == word + letter)
      return true;
  if (axis == 0)
    return is_one_of(name, {"easting", "east", "eastings", "utmeasting", "rechtswert"});
  if (axis == 1)
    return is_one_of(name, {"northing", "north", "northings", "utmnorthing", "hochwert"});
  return is_one_of(name, {"height", "elevation", "elev", "altitude"});
}

//! the columns of x, y and z, or the reason why they are unknown
struct Coordinate_columns
{
  std::array<std::size_t, 3> index{};
  std::string error; // empty if all three were found
};

inline Coordinate_columns find_coordinate_columns(const std::vector<std::string>& names)
{
  Coordinate_columns result;
  bool has_degrees = false;
  std::vector<std::string> plain;
  for (const std::string& name : names) {
    plain.push_back(plain_name(name));
    has_degrees =
        has_degrees || is_one_of(plain.back(), {"lon", "long", "longitude", "lat", "latitude"});
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char letter = static_cast<char>('x' + axis);
    const auto is_letter = [&](const std::string& name) {
      return to_lower(without_quotes(name)) == std::string(1, letter);
    };
    std::size_t i = 0;
    while (i < names.size() && !is_letter(names[i]))
      ++i;
    for (std::size_t k = 0; k < names.size() && i == names.size(); ++k)
      if (is_coordinate_alias(plain[k], axis)) {
        for (std::size_t other = k + 1; other < names.size(); ++other)
          if (is_coordinate_alias(plain[other], axis))
            result.error = "both " + in_quotes(names[k]) + " and " + in_quotes(names[other]) +
                           " may be '" + letter + "'; name one of them '" + letter + "'";
        i = k;
      }
    if (i == names.size() && result.error.empty())
      result.error = has_degrees
                         ? "longitude and latitude are angles; convert them to a map projection, "
                           "for example with cs2cs, and name the columns x, y and z"
                         : "expected numbers, or the names of the columns with x, y and z; '" +
                               std::string(1, letter) + "' is missing";
    result.index[axis] = i;
  }
  return result;
}

//! the columns of a normal with names such as Nx, N_y or NormalZ in any letter case, or an empty
//! list unless each of the three has exactly one column
inline std::vector<std::size_t> find_normal_columns(const std::vector<std::string>& names)
{
  std::vector<std::size_t> result;
  for (const char letter : {'x', 'y', 'z'}) {
    const auto is_component = [&](const std::string& name) {
      const std::string plain = plain_name(name);
      return plain == std::string("n") + letter || plain == std::string("normal") + letter;
    };
    if (std::count_if(names.begin(), names.end(), is_component) != 1)
      return {};
    result.push_back(static_cast<std::size_t>(
        std::find_if(names.begin(), names.end(), is_component) - names.begin()));
  }
  return result;
}

//! whether a line below the names contains units: the coordinates have a unit of length
inline bool are_units(const Table_words& words, const std::array<std::size_t, 3>& coordinates)
{
  for (const std::size_t i : coordinates)
    if (i >= words.size() || !is_one_of(plain_name(words[i]),
                                        {"m",
                                         "cm",
                                         "mm",
                                         "km",
                                         "ft",
                                         "feet",
                                         "foot",
                                         "usft",
                                         "meter",
                                         "meters",
                                         "metre",
                                         "metres",
                                         "in",
                                         "inch"}))
      return false;
  return true;
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_TEXT_COORDINATE_COLUMNS_H
