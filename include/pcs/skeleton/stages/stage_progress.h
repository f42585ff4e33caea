// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Progress of the stages of a skeletonization.

#ifndef PCS_SKELETON_STAGES_STAGE_PROGRESS_H
#define PCS_SKELETON_STAGES_STAGE_PROGRESS_H

#include <pcs/internal/progress.h>
#include <pcs/skeleton/Session_state.h>

namespace pcs {
namespace skeleton {

namespace internal {

/// Fractions of the work after which the stages end.
constexpr double end_of_neighbors = 0.35, end_of_clutter = 0.42, end_of_paths = 0.6,
                 end_of_first_fit = 0.75, end_of_fits = 0.82, end_of_coarse_fits = 0.87,
                 end_of_axes = 0.9, end_of_joints = 0.95, end_of_radii = 0.97;

template <class Tag>
bool finish(Session_state<Tag>& s, Stage stage, double end, pcs::internal::Progress& progress)
{
  s.stage = stage;
  return progress(end);
}

} // namespace internal

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_STAGES_STAGE_PROGRESS_H
