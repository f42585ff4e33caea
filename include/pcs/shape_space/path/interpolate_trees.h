// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Interpolation and extrapolation between two trees of a family.

#ifndef PCS_SHAPE_SPACE_PATH_INTERPOLATE_TREES_H
#define PCS_SHAPE_SPACE_PATH_INTERPOLATE_TREES_H

#include <pcs/core/errors.h>
#include <pcs/internal/text.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Path_options.h>
#include <pcs/shape_space/model/Tree_family.h>
#include <pcs/shape_space/path/Extrapolation_limits.h>
#include <pcs/shape_space/path/Sequential_births.h>
#include <pcs/shape_space/path/Tree_state.h>

#include <string>

namespace pcs {
namespace shape_space {

/// Writes the tree at `t` on the geodesic from `a` (0) to `b` (1) to `result`, whose memory is
/// reused. Throws `Invalid_input`, with a message that begins with `caller`, if its positions are
/// not finite.
inline void interpolate_trees(const Tree_family& family,
                              const Orl_coordinates& a,
                              const Orl_coordinates& b,
                              double t,
                              const Path_options& options,
                              const char* caller,
                              Tree_state& result)
{
  coordinates_at(family.layout,
                 a,
                 b,
                 t,
                 options.max_extrapolation_angle,
                 result.x,
                 options.extrapolation);
  if (options.emergence == Branch_emergence::sequential && t > 0 && t < 1)
    Sequential_births(family.layout, result.births)(a, b, t, result.x);
  if ((t < 0 || t > 1) && options.extrapolation == Orl_extrapolation::bounded)
    Extrapolation_limits(family.layout,
                         family.orientation,
                         family.up,
                         options.max_extrapolation_angle,
                         result.extrapolation)(t < 0 ? a : b, t < 0 ? b : a, result.x);
  if (options.do_limit_radii)
    limit_radii(family.layout, result.x);
  build_geometry(family.layout, result.x, family.orientation, result.geometry);
  for (const Vec3& p : result.geometry.node)
    if (!p.allFinite())
      throw Invalid_input(std::string(caller) + ": `lambda` is " + pcs::internal::to_text(t) +
                          ", where lengths are not finite; choose a value nearer to [0, 1]");
  family.find_offsets(result.x, result.first_point);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_PATH_INTERPOLATE_TREES_H
