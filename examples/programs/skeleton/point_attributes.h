// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Attributes of the points of a scan: wood labels and scanner stations.

#ifndef PCS_EXAMPLES_PROGRAMS_SKELETON_POINT_ATTRIBUTES_H
#define PCS_EXAMPLES_PROGRAMS_SKELETON_POINT_ATTRIBUTES_H

#include <pcs/IO/points/Point_table.h>
#include <pcs/core/errors.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace program {

/// The option --wood: NAME, or NAME=VALUE for labels with another value of wood than 1.
struct Wood_option
{
  std::string property;
  std::optional<double> value; ///< value of wood; none: 1
};

/// Parses the option. Throws `pcs::Invalid_input` if the text after the last `=` is not a number.
inline Wood_option parse_wood(const std::string& text)
{
  const std::size_t at = text.rfind('=');
  if (at == std::string::npos)
    return {text.empty() ? "wood" : text, {}};
  double value = 0;
  if (at == 0 || at + 1 == text.size() || !CLI::detail::lexical_cast(text.substr(at + 1), value) ||
      !std::isfinite(value))
    throw pcs::Invalid_input("--wood is '" + text +
                             "'; expected PROPERTY or PROPERTY=VALUE, for example label=4");
  return {text.substr(0, at), value};
}

/// Lists the names of the properties, for messages.
inline std::string list_properties(const pcs::IO::Point_table& table)
{
  std::string text;
  for (const pcs::IO::Property_description& property : table.schema().properties)
    text += (text.empty() ? "it has " : ", ") + property.name;
  return text;
}

/// Lists the first distinct values with the numbers of their points, for messages.
inline std::string list_values(const std::vector<double>& values)
{
  constexpr std::size_t max_listed = 6, max_counted = 1000;
  std::map<double, std::size_t> counts;
  std::size_t number_of_nan = 0;
  for (const double x : values)
    if (std::isnan(x))
      ++number_of_nan;
    else if (counts.size() < max_counted || counts.count(x) > 0)
      ++counts[x];
  std::ostringstream out;
  std::size_t k = 0;
  for (const auto& [x, count] : counts) {
    if (k == max_listed)
      return out.str() + ", ...";
    out << (k++ > 0 ? ", " : "") << x << " (" << count << (count == 1 ? " point)" : " points)");
  }
  if (number_of_nan > 0)
    out << (k > 0 ? ", " : "") << "NaN (" << number_of_nan << " points)";
  return out.str();
}

/// Returns the largest value as text, for examples in messages; 1 if no value is a number.
inline std::string largest_value(const std::vector<double>& values)
{
  bool is_number = false;
  double most = 1;
  for (const double x : values)
    if (!std::isnan(x) && (!is_number || x > most)) {
      most = x;
      is_number = true;
    }
  std::ostringstream out;
  out << most;
  return out.str();
}

/*!
  Returns which points are wood, from the property of --wood or from a property `wood`; empty if it
  does not exist. `wood_values` are the values of --wood-value. Throws `pcs::Invalid_input` if the
  property of --wood is missing, if its values are not 0 and 1 and the values of wood are not
  specified, because programs number their classes differently, or if no point is wood. `warning` is
  set if all points are wood.
*/
inline std::vector<std::uint8_t> wood_of_points(const pcs::IO::Point_table& table,
                                                const std::string& option,
                                                const std::vector<double>& wood_values,
                                                std::string& warning)
{
  const Wood_option wood = parse_wood(option);
  if (wood.value && !wood_values.empty())
    throw pcs::Invalid_input("the values of wood are given twice, by --wood " + option +
                             " and by --wood-value; use one of them");
  if (!table.has_property(wood.property)) {
    if (option.empty() && wood_values.empty())
      return {};
    throw pcs::Invalid_input(
        "the scan has no property '" + wood.property +
        "'; name the property of the labels with --wood: " + list_properties(table));
  }
  const std::vector<double> values = table.property_as_double(wood.property);
  if (!wood.value && wood_values.empty())
    for (const double x : values)
      if (!(x == 0 || x == 1))
        throw pcs::Invalid_input(
            "property '" + wood.property + "' has the values " + list_values(values) +
            "; expected 1 for wood and 0 for leaves. Name the values of wood with --wood-value, "
            "for example --wood " +
            wood.property + " --wood-value " + largest_value(values));
  std::vector<double> accepted = wood_values;
  if (accepted.empty())
    accepted.push_back(wood.value.value_or(1));
  std::vector<std::uint8_t> is_wood(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    is_wood[i] = std::find(accepted.begin(), accepted.end(), values[i]) != accepted.end();
  if (!values.empty() && std::find(is_wood.begin(), is_wood.end(), 1) == is_wood.end())
    throw pcs::Invalid_input("no point is wood: property '" + wood.property + "' has the values " +
                             list_values(values) +
                             "; name the values of wood with --wood-value, or use another property "
                             "with --wood");
  if (std::find(is_wood.begin(), is_wood.end(), 0) == is_wood.end())
    warning = "all points are wood: property '" + wood.property + "' has the values " +
              list_values(values);
  return is_wood;
}

/*!
  Returns the station of each point, from the property of --stations or from a property `station`;
  -1 if unknown. Empty if there is no such property. The LAS attribute `point_source_id` is used
  only if it is specified: in airborne scans it is the flight line, whose points have no common
  scanner position.
*/
inline std::vector<long long> stations_of_points(const pcs::IO::Point_table& table,
                                                 const std::string& option)
{
  const std::string name = option.empty() ? "station" : option;
  if (!table.has_property(name)) {
    if (option.empty())
      return {};
    throw pcs::Invalid_input(
        "the scan has no property '" + name +
        "'; name that of the stations with --stations: " + list_properties(table));
  }
  std::vector<long long> stations;
  for (const double x : table.property_as_double(name))
    stations.push_back(x >= 0 && x < 1e15 ? std::llround(x) : -1);
  return stations;
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SKELETON_POINT_ATTRIBUTES_H
