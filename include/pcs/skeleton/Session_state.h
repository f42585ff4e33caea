// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Input, options and results of the stages of a skeletonization.

#ifndef PCS_SKELETON_SESSION_STATE_H
#define PCS_SKELETON_SESSION_STATE_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/skeleton/Session_options.h>
#include <pcs/skeleton/scan/Point_labels.h>
#include <pcs/skeleton/slices/section_skeleton.h>

#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// The last completed stage.
enum class Stage { input, neighbors, paths, fits, axes, joints };

/// Input and results of all stages. They persist after a cancelled call.
template <class ConcurrencyTag>
struct Session_state
{
  // ---- the task
  std::vector<Vec3> input;           ///< empty once it was moved to `scan`
  std::vector<std::uint8_t> is_wood; ///< of the input; empty: unknown
  //! after `Stage::neighbors`, `up`, `breast_height` and `scanners` are in coordinates of the scan;
  //! `root` and `given` remain in those of the input
  Session_options options;

  // ---- progress
  Stage stage = Stage::input;
  Leaf_state leaves;  ///< completed rounds of the leaf-wood separation
  Joined_axes joined; ///< number of completed regroupings; joints and branches (a result)

  // ---- results, in the order of the stages
  Skeleton_report report;
  Scan scan;
  Point_labels<ConcurrencyTag> labels{scan, report};
  std::vector<std::uint8_t> may_be_tree; ///< for a given skeleton: the used points before removals
  Clutter_removal<ConcurrencyTag> clutter{scan, options.clutter, labels, report};
  std::vector<Index> root;
  Leaf_blades blades; ///< if the method is not known yet
  Shortest_paths paths;
  Layer_tree layers;
  Axis_set axes;
  std::vector<Found_section> sections; ///< of the method `sections`
  std::vector<Index> successors;       ///< next node on the branch, by node of the tree

  const std::vector<std::uint8_t>& is_used() const { return labels.flags(); }
  bool has_axes() const { return options.method == Skeleton_method::chains; }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SESSION_STATE_H
