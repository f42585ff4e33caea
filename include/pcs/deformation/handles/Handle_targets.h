// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points of a handle, and their target positions.

#ifndef PCS_DEFORMATION_HANDLES_HANDLE_TARGETS_H
#define PCS_DEFORMATION_HANDLES_HANDLE_TARGETS_H

#include <pcs/core/errors.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/model/Local_frame.h>
#include <pcs/internal/text.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcs {
namespace deformation {

/// The points of a handle and their softness. Sets of handles and snapshots share these objects.
struct Handle_points
{
  std::vector<std::uint32_t> sites;      ///< each once
  std::vector<std::uint32_t> components; ///< of the sites, increasing
  /// The position in `sites` of each given point; empty if no two points are at the same place.
  std::vector<std::uint32_t> place_of_point;
  double weight = 0; ///< 0: exact; positive: soft, see `Node_constraints`

  std::size_t number_of_points() const
  {
    return place_of_point.empty() ? sites.size() : place_of_point.size();
  }
};

/// Target positions of a handle. Sets of handles and snapshots share these objects.
struct Handle_targets
{
  std::vector<Vec3> of_sites; ///< of `Handle_points::sites`, in the caller's coordinates [L]
};

/// Throws `Invalid_input`, with a message that begins with `of_handle`, unless there is one finite
/// target per point. \param largest distance from the origin of the frame [extents]
inline void check_targets(const Handle_points& points,
                          const std::vector<Vec3>& targets,
                          const Local_frame& frame,
                          double largest,
                          const std::string& of_handle)
{
  const std::size_t count = points.number_of_points();
  if (targets.size() != count)
    throw Invalid_input(of_handle + " has " + std::to_string(count) + " points, but " +
                        std::to_string(targets.size()) +
                        " targets are given; give one for each point, in the order of the points "
                        "in add_handle()");
  for (std::size_t k = 0; k < count; ++k) {
    if (!targets[k].allFinite())
      throw Invalid_input(of_handle + ": target " + std::to_string(k) + " is not finite");
    const double distance = frame.to_local(targets[k]).norm();
    if (!(distance < largest))
      throw Invalid_input(
          of_handle + ": target " + std::to_string(k) + " is " + pcs::internal::to_text(distance) +
          " extents of the cloud away; it must be less than " + pcs::internal::to_text(largest));
  }
}

/// Returns one target per site. Throws `Invalid_input`, with a message that begins with
/// `of_handle`, if points at the same place have different targets.
inline std::vector<Vec3> targets_of_sites(const Handle_points& points,
                                          const std::vector<Vec3>& targets,
                                          const std::string& of_handle)
{
  if (points.place_of_point.empty())
    return targets;
  constexpr std::size_t none = ~std::size_t(0);
  std::vector<std::size_t> first(points.sites.size(), none);
  std::vector<Vec3> result(points.sites.size());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const std::uint32_t place = points.place_of_point[k];
    if (first[place] == none) {
      first[place] = k;
      result[place] = targets[k];
    } else if (targets[k] != result[place])
      throw Invalid_input(of_handle + ": targets " + std::to_string(first[place]) + " and " +
                          std::to_string(k) +
                          " differ, but their points are at the same place; give them the same "
                          "target");
  }
  return result;
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_HANDLE_TARGETS_H
