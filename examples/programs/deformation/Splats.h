// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Gaussian splats of a table: recognition by the names of their properties, and transformation.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_SPLATS_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_SPLATS_H

#include "deformation/Run_report.h"
#include <pcs/IO/points/Point_schema.h>
#include <pcs/IO/points/Point_table.h>
#include <pcs/IO/points/Scalar_type.h>
#include <pcs/core/errors.h>
#include <pcs/splats/rotate_harmonics.h>
#include <pcs/splats/transform_splats.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace program {

using Gradients = std::vector<Eigen::Matrix3d>;

/// Which properties of a table are attributes of splats.
struct Splat_properties
{
  std::vector<std::string> rotation;  ///< w, x, y, z
  std::vector<std::string> log_scale; ///< two or three
  std::vector<std::string> harmonics; ///< `f_rest_0`, ...
  pcs::IO::Scalar_type type = pcs::IO::Scalar_type::float32;
};

/// Returns the names `prefix0`, `prefix1`, ... of `count` properties.
inline std::vector<std::string> numbered_names(const std::string& prefix, std::size_t count)
{
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i)
    names.push_back(prefix + std::to_string(i));
  return names;
}

/// Returns the first of the properties that is missing.
inline std::optional<std::string> first_missing(const pcs::IO::Point_schema& schema,
                                                const std::vector<std::string>& names)
{
  for (const std::string& name : names)
    if (!schema.has(name))
      return name;
  return std::nullopt;
}

/// Returns the names of the coefficients. Throws `pcs::Invalid_input` if one is missing or their
/// number is not that of a degree.
inline std::vector<std::string> find_harmonics(const pcs::IO::Point_schema& schema)
{
  const std::string prefix = "f_rest_";
  const auto count = static_cast<std::size_t>(
      std::count_if(schema.properties.begin(), schema.properties.end(), [&](const auto& p) {
        return p.name.compare(0, prefix.size(), prefix) == 0;
      }));
  pcs::splats::degree_of_harmonics(count);
  std::vector<std::string> names = numbered_names(prefix, count);
  if (const auto missing = first_missing(schema, names))
    throw pcs::Invalid_input("the " + std::to_string(count) + " properties f_rest_... of splats " +
                             "must be numbered from 0, but there is no property " + *missing);
  return names;
}

/// Throws `pcs::Invalid_input` unless all properties have the same floating point type.
inline pcs::IO::Scalar_type common_type(const pcs::IO::Point_schema& schema,
                                        const std::vector<std::string>& names)
{
  const pcs::IO::Property_description& first = schema.properties[schema.find(names.front())];
  for (const std::string& name : names) {
    const pcs::IO::Property_description& p = schema.properties[schema.find(name)];
    if (!pcs::IO::is_floating_point(p.type) || p.type != first.type)
      throw pcs::Invalid_input(
          "the properties of splats must all be float or all be double, but '" + first.name +
          "' is of type " + pcs::IO::name_of(first.type) + ", and '" + p.name + "' is of type " +
          pcs::IO::name_of(p.type));
  }
  return first.type;
}

/*!
  Returns the properties of splats if the points have rotations and scales as files of 3D Gaussian
  splatting have them. Adds a warning if only some of these properties exist: the points are then
  deformed as points. Throws `pcs::Invalid_input` if the coefficients of the colours are malformed.
*/
inline std::optional<Splat_properties> find_splats(const pcs::IO::Point_schema& schema,
                                                   std::vector<std::string>& warnings)
{
  Splat_properties splats;
  splats.rotation = numbered_names("rot_", 4);
  splats.log_scale = numbered_names("scale_", schema.has("scale_2") ? 3 : 2);
  std::vector<std::string> all = splats.rotation;
  all.insert(all.end(), splats.log_scale.begin(), splats.log_scale.end());
  if (const auto missing = first_missing(schema, all)) {
    if (schema.has("rot_0") || schema.has("scale_0") || schema.has("f_dc_0"))
      warnings.push_back("the points have properties of Gaussian splats, but no property " +
                         *missing + ": positions and normals are deformed, and all other " +
                         "properties are left as they are");
    return std::nullopt;
  }
  splats.harmonics = find_harmonics(schema);
  all.insert(all.end(), splats.harmonics.begin(), splats.harmonics.end());
  splats.type = common_type(schema, all);
  return splats;
}

/// Transforms the splats of a table by one gradient each, which may be empty if there are none.
template <class FT>
void transform_columns(pcs::IO::Point_table& table,
                       const Splat_properties& names,
                       const Gradients& gradients,
                       Run_report& run)
{
  pcs::splats::Splat_columns<FT> columns;
  for (std::size_t k = 0; k < names.rotation.size(); ++k)
    columns.rotation[k] = table.property<FT>(names.rotation[k]).data();
  for (std::size_t k = 0; k < names.log_scale.size(); ++k)
    columns.log_scale[k] = table.property<FT>(names.log_scale[k]).data();
  for (const std::string& name : names.harmonics)
    columns.harmonics.push_back(table.property<FT>(name).data());
  run.number_of_invalid_splats += pcs::splats::transform_splats(gradients, columns);
}

inline void transform_splats(pcs::IO::Point_table& table,
                             const Splat_properties& names,
                             const Gradients& gradients,
                             Run_report& run)
{
  if (gradients.empty())
    return;
  if (names.type == pcs::IO::Scalar_type::float32)
    transform_columns<float>(table, names, gradients, run);
  else
    transform_columns<double>(table, names, gradients, run);
}

/// Returns coordinates that differ from those at rest only by rounding to the values at rest, so
/// that splats keep their bits where nothing moves. `size` is the largest coordinate of the file.
inline void keep_resting_coordinates(const std::vector<pcs::IO::Point_table::Point_3>& rest,
                                     double size,
                                     std::vector<pcs::IO::Point_table::Point_3>& points)
{
  constexpr double rounding = 1e-12; // of the solution; the type `float` has a precision of 6e-8
  for (std::size_t i = 0; i < points.size(); ++i) {
    double kept[3];
    for (int axis = 0; axis < 3; ++axis)
      kept[axis] = std::abs(points[i][axis] - rest[i][axis]) <= rounding * size ? rest[i][axis]
                                                                                : points[i][axis];
    points[i] = {kept[0], kept[1], kept[2]};
  }
}

/// Notes in the report that the points are splats.
inline void note_splats(const Splat_properties& names, Run_report& run)
{
  run.degree_of_splats = pcs::splats::degree_of_harmonics(names.harmonics.size());
}

inline void warn_of_invalid_splats(Run_report& run)
{
  if (run.number_of_invalid_splats > 0)
    run.warnings.push_back(std::to_string(run.number_of_invalid_splats) +
                           " splats have rotations or scales that are not finite: only their "
                           "positions and normals are deformed");
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_SPLATS_H
