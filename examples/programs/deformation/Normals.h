// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Normals of a table as vectors, and back in the types of their properties.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_NORMALS_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_NORMALS_H

#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Scalar_type.h>

#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace program {

using Normal_vectors = std::vector<pcs::IO::Point_table::Vector_3>;

inline bool is_finite(const pcs::IO::Point_table::Vector_3& v)
{
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

/// Returns the first point whose normal is not finite.
inline std::optional<std::size_t> first_invalid(const Normal_vectors& normals)
{
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (!is_finite(normals[i]))
      return i;
  return std::nullopt;
}

inline std::string invalid_normal_warning(std::uint64_t number)
{
  return "the normal of point " + std::to_string(number) +
         " is not finite: all normals are left as they are";
}

/// Adds a warning if properties look like a normal but do not have the names by which normals are
/// known.
inline void warn_of_unknown_normals(const pcs::IO::Point_schema& schema,
                                    std::vector<std::string>& warnings)
{
  const bool is_known = schema.has("nx") && schema.has("ny") && schema.has("nz");
  std::string found;
  for (const pcs::IO::Property_description& property : schema.properties) {
    std::string letters;
    for (const char c : property.name)
      if (std::isalpha(static_cast<unsigned char>(c)) != 0)
        letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const bool is_name = property.name == "nx" || property.name == "ny" || property.name == "nz";
    for (const char* prefix : {"n", "normal", "normals"})
      for (const char axis : {'x', 'y', 'z'})
        if (letters == std::string(prefix) + axis && !(is_known && is_name))
          found += (found.empty() ? "" : ", ") + property.name;
  }
  if (!found.empty())
    warnings.push_back("the properties " + found +
                       " are left as they are: normals need the three names nx, ny and nz");
}

/// Converts a value; rounds and clamps it if `T` is an integer type.
template <class T>
T to_property(double value)
{
  if constexpr (std::is_integral_v<T>) {
    const double lowest = static_cast<double>(std::numeric_limits<T>::lowest());
    const double highest = static_cast<double>(std::numeric_limits<T>::max());
    if (value <= lowest)
      return std::numeric_limits<T>::lowest();
    if (value >= highest)
      return std::numeric_limits<T>::max();
    return static_cast<T>(std::round(value));
  } else
    return static_cast<T>(value);
}

/// Stores normals; those whose squared length overflows are left unchanged.
inline void store_normals(pcs::IO::Point_table& table, const Normal_vectors& normals)
{
  constexpr const char* names[] = {"nx", "ny", "nz"};
  for (int axis = 0; axis < 3; ++axis)
    pcs::IO::dispatch(table.property_type(names[axis]), [&](auto tag) {
      using T = typename decltype(tag)::type;
      std::vector<T>& values = table.property<T>(names[axis]);
      for (std::size_t i = 0; i < values.size(); ++i)
        if (is_finite(normals[i])) {
          const T value = to_property<T>(normals[i][axis]);
          if (value != values[i]) // a zero keeps its sign
            values[i] = value;
        }
    });
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_NORMALS_H
