// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// An edit: the points that each handle selects, and its motion.

#ifndef PCS_EXAMPLES_PROGRAMS_DEFORMATION_EDIT_H
#define PCS_EXAMPLES_PROGRAMS_DEFORMATION_EDIT_H

#include <pcs/IO/points/Point_table.h>
#include <pcs/core/Similarity.h>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace program {

using Vec3 = Eigen::Vector3d;

inline Vec3 to_vec3(const pcs::IO::Point_table::Point_3& p)
{
  return {p.x(), p.y(), p.z()};
}

/// Selects points between two corners, bounds included.
struct Box
{
  Vec3 low, high;
};

/// Selects points within `radius` of `center`.
struct Sphere
{
  Vec3 center;
  double radius = 0;
};

/// Selects points by the value of a property. Integers are stored as integers, since a double
/// cannot represent 64 bits.
struct Property_equals
{
  std::string name;
  std::variant<std::int64_t, std::uint64_t, double> value;
};

/// Selects points by index, from 0.
struct Index_list
{
  std::vector<std::uint64_t> indices;
};

using Selector = std::variant<Box, Sphere, Property_equals, Index_list>;

struct Rotation
{
  Vec3 axis = Vec3::UnitZ();
  double degrees = 0;
  std::optional<Vec3> center; ///< also the fixed point of the scale; by default the centroid
};

/// Scale, then rotation, then translation; or a matrix or one target per point instead. Without any
/// of them the points keep their positions.
struct Motion
{
  std::optional<double> scale;
  std::optional<Rotation> rotation;
  std::optional<Vec3> translation;
  std::optional<pcs::Similarity> matrix;
  std::vector<Vec3> targets; ///< in the order of the `Index_list` of the handle

  bool is_fixed() const
  {
    return !scale && !rotation && !translation && !matrix && targets.empty();
  }
};

struct Handle
{
  std::string pointer; ///< JSON pointer to the handle, for messages
  Selector selector;
  Motion motion;
  double softness = 0;
};

struct Edit
{
  std::string source; ///< name of the file, for messages
  std::vector<Handle> handles;
};

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_DEFORMATION_EDIT_H
