// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Sets one target position per point of a handle.

#ifndef PCS_DEFORMATION_HANDLES_SET_TARGETS_H
#define PCS_DEFORMATION_HANDLES_SET_TARGETS_H

#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Handle_set.h>
#include <pcs/deformation/handles/Handle_targets.h>
#include <pcs/deformation/handles/fit_rigid_motion.h>
#include <pcs/deformation/model/Local_frame.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcs {
namespace deformation {

namespace internal {

/// Returns the rigid motion in the caller's coordinates that is `local` in those of the body.
inline Similarity to_world(const Local_frame& frame, const Similarity& local)
{
  Similarity turn;
  for (const auto& t : local.turns())
    turn = Similarity::from_turn(t) * turn;
  return Similarity::from_translation(frame.unit * local.translation()) *
         Similarity::about(turn, frame.origin);
}

} // namespace internal

/// Sets one target for each point of a handle, in the order of `Handle_set::add()`, and the rigid
/// motion that fits them best. Throws `Invalid_input`, and changes nothing, if their number is
/// another one, a target is not finite or too far away, or points at the same place have different
/// targets. O(points of the handle).
template <class ConcurrencyTag>
void set_targets(const Sampled_body<ConcurrencyTag>& body,
                 std::size_t handle,
                 const std::vector<Vec3>& targets,
                 const char* function,
                 Handle_set& handles)
{
  const Handle_points& points = *handles.points()[handle];
  const std::string of_handle = std::string(function) + ": handle " + std::to_string(handle);
  check_targets(points, targets, body.frame, Handle_set::largest_motion, of_handle);
  auto given = std::make_shared<Handle_targets>();
  given->of_sites = targets_of_sites(points, targets, of_handle);
  std::vector<Vec3> rest, target;
  for (const auto site : points.sites)
    rest.push_back(body.rest_of_site(site));
  for (const Vec3& t : given->of_sites)
    target.push_back(body.frame.to_local(t));
  if (rest == target) {
    handles.set_transform(body.frame, handle, Similarity());
    return;
  }
  const Similarity motion = internal::to_world(body.frame, fit_rigid_motion(rest, target));
  handles.set_targets(body.frame, handle, motion, std::move(given));
}

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_HANDLES_SET_TARGETS_H
