// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Data of an editing session, and the settings of its handles and rest shape.

#ifndef PCS_DEFORMATION_SESSION_STATE_H
#define PCS_DEFORMATION_SESSION_STATE_H

#include <pcs/core/Deformation_report.h>
#include <pcs/core/Similarity.h>
#include <pcs/deformation/body/Sampled_body.h>
#include <pcs/deformation/handles/Target_field.h>
#include <pcs/deformation/handles/constrain_body.h>
#include <pcs/deformation/model/Affine_map.h>
#include <pcs/deformation/multigrid/Coarse_levels.h>
#include <pcs/deformation/solver/Elastic_solver.h>
#include <pcs/deformation/upsampling/Dirty_handles.h>
#include <pcs/deformation/upsampling/Handle_fades.h>
#include <pcs/deformation/upsampling/Outlier_maps.h>
#include <pcs/deformation/upsampling/Point_carrier.h>
#include <pcs/deformation/upsampling/Rest_positions.h>
#include <pcs/deformation/upsampling/Target_corrections.h>
#include <pcs/deformation/upsampling/Upsampling.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcs {
namespace deformation {

/*!
  The data of a session. A *setting* is a number that identifies the session, its handles and its
  rest shape; it changes whenever handles or the rest shape change. A snapshot brings back the
  setting of its handles.
*/
template <class ConcurrencyTag>
struct Session_state
{
  // ---- derived from the points; unusable if the construction was cancelled
  Sampled_body<ConcurrencyTag> body;
  Border_finder border_finder; ///< for the body's site graph, if the body is sampled
  Upsampling upsampling;       ///< if the body is sampled
  Coarse_levels<ConcurrencyTag> coarse;
  bool is_ready = false;

  // ---- the handles as the caller set them; no other call changes them
  Handle_set handles;
  std::uint64_t setting = 0;      ///< of the current handles and rest shape
  std::uint64_t rest_setting = 0; ///< the first setting of the rest shape

  // ---- constraints of these handles; a cancelled factorisation leaves the sites and fades, and no
  // ---- factors; a cancelled solve does not change them
  Site_constraints sites;
  /// The samples and the nodes on the borders of handles. Without sampling, these nodes are added
  /// to `body.network`, and `cut` has the edges that are missing there.
  Elastic_network network;
  Cut_edges cut;
  Node_constraints of_samples;
  Elastic_solver<ConcurrencyTag> solver;
  Handle_fades fades;
  double stiffness = 1;
  bool is_constrained = false;        ///< whether the matrices of this setting are factorised
  std::uint64_t setting_of_sites = 0; ///< setting for which `sites` were found

  // ---- the state of the solver; a cancelled solve invalidates it, and the next solve starts cold
  bool has_solution = false; ///< under the current constraints
  double last_energy = 0;    ///< of the solution

  // ---- the current shape; a cancelled solve does not change it
  std::vector<Affine_map> maps;             ///< of the samples; empty for large bodies at rest
  std::vector<Similarity> local_transforms; ///< of the handles, for these maps
  std::vector<Similarity> shape_transforms; ///< of the handles, in the caller's coordinates
  std::vector<std::shared_ptr<const Handle_targets>> shape_targets; ///< of the handles
  Target_corrections corrections;                                   ///< from `shape_targets`
  std::uint64_t setting_of_shape = 0; ///< setting for which the shape was solved
  bool is_at_rest = true;

  // ---- memory of the next shape, kept so that frames allocate nothing
  std::vector<Similarity> next_transforms;
  Target_field next_targets;
  std::vector<Affine_map> next_maps; ///< empty for large bodies, see `read_maps()`
  std::vector<int> are_finite;

  // ---- output, computed from the current shape
  Rest_positions rest_positions;
  Dirty_handles dirty_handles; ///< handles with points displaced by earlier writes
  Outlier_maps outlier_maps;
  std::vector<Handle_map> handle_maps;
  std::unique_ptr<Point_carrier> carrier; ///< for the current rest shape; null until it is needed

  Deformation_report report;
  bool was_reported = false; ///< the first report includes the seconds of the construction
};

namespace internal {

// ---- settings and shapes

/// Whether the factors are those of the current handles and stiffness.
template <class Tag>
bool is_factorized(const Session_state<Tag>& s, double stiffness)
{
  return s.is_constrained && s.setting_of_sites == s.setting && stiffness == s.stiffness;
}

/// Marks the shape as the rest shape, which is valid for all handles.
template <class Tag>
void keep_rest(Session_state<Tag>& s)
{
  s.shape_transforms.assign(s.handles.size(), Similarity());
  s.shape_targets.assign(s.handles.size(), nullptr);
  s.corrections.clear();
  s.setting_of_shape = s.setting;
  s.is_at_rest = true;
}

/// Begins a new setting after handles or the rest shape changed.
template <class Tag>
void begin_setting(Session_state<Tag>& s)
{
  static std::atomic<std::uint64_t> last{0};
  s.setting = ++last;
  if (s.is_at_rest)
    keep_rest(s);
}

/// Begins the first setting of a rest shape. Earlier snapshots cannot be restored.
template <class Tag>
void begin_rest_shape(Session_state<Tag>& s)
{
  begin_setting(s);
  s.rest_setting = s.setting;
}

/// Larger bodies, in which a frame takes a large part of a second, compute every map twice rather
/// than to store it twice, and have no maps at rest. [count]
constexpr std::size_t most_next_maps = 65536;

/// Sets all maps to the identity.
template <class Tag>
void start_maps(Session_state<Tag>& s)
{
  if (s.body.number_of_samples() <= most_next_maps)
    s.maps.assign(s.body.number_of_samples(), identity_map());
  else
    s.maps = std::vector<Affine_map>();
}

/// Provides the maps of a large body at rest, for output.
template <class Tag>
void complete_maps(Session_state<Tag>& s)
{
  if (s.maps.empty())
    s.maps.assign(s.body.number_of_samples(), identity_map());
}

template <class Tag>
void put_samples_at_rest(Session_state<Tag>& s)
{
  start_maps(s);
  keep_rest(s);
}

/// Converts the transformations set by the caller to local coordinates.
template <class Tag>
void localize_transforms(Session_state<Tag>& s)
{
  s.handles.local_transforms(s.body.frame, s.local_transforms);
}

/// Adds identities for handles that were added since the last solve. The outside of the region of
/// interest remains the last handle.
template <class Tag>
void complete_transforms(Session_state<Tag>& s)
{
  const std::size_t outside_count = s.handles.has_outside() ? 1 : 0;
  if (s.local_transforms.size() == s.handles.size() + outside_count)
    return;
  if (!s.local_transforms.empty())
    s.local_transforms.resize(s.local_transforms.size() - outside_count);
  s.local_transforms.resize(s.handles.size() + outside_count);
}

} // namespace internal

} // namespace deformation
} // namespace pcs

#endif // PCS_DEFORMATION_SESSION_STATE_H
