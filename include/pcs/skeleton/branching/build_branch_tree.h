// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// One rooted tree of branches from the fitted axes.

#ifndef PCS_SKELETON_BRANCHING_BUILD_BRANCH_TREE_H
#define PCS_SKELETON_BRANCHING_BUILD_BRANCH_TREE_H

#include <pcs/skeleton/branching/align_base_with_root.h>
#include <pcs/skeleton/branching/fuse_axes.h>
#include <pcs/skeleton/branching/group_branches.h>
#include <pcs/skeleton/branching/join_axes.h>
#include <pcs/skeleton/branching/prune_stubs.h>
#include <pcs/skeleton/branching/regroup_axes.h>
#include <pcs/skeleton/branching/root_axis.h>
#include <pcs/skeleton/branching/split_unreachable_axes.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Joint.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of `build_branch_tree()`.
struct Branching_options
{
  Fusion_options fusion;
  Joint_options joints;
  Base_alignment_options base;
  Stub_options stubs;
};

/// The tree of the axes, which may be incomplete after a cancelled call.
struct Joined_axes
{
  int regroupings = 0;         ///< completed rounds [count]
  int aligned = -1;            ///< round in which the base was last aligned with the root; -1: none
  Index root = none;           ///< the axis of the root
  std::vector<Index> standing; ///< axes that stand on the ground beside the tree
  std::vector<Joint> joints;
  Branch_tree tree;
};

/// Returns which axes stand on the ground beside the tree, or are joined to such an axis. O(axes).
inline std::vector<std::uint8_t> axes_of_objects(const Joined_axes& joined)
{
  std::vector<std::uint8_t> is_object(joined.joints.size(), 0);
  if (joined.standing.empty())
    return is_object;
  std::vector<std::vector<Index>> children(joined.joints.size());
  for (Index a = 0; a < joined.joints.size(); ++a)
    if (joined.joints[a].parent != none)
      children[joined.joints[a].parent].push_back(a);
  std::vector<Index> stack = joined.standing;
  while (!stack.empty()) {
    const Index a = stack.back();
    stack.pop_back();
    is_object[a] = 1;
    stack.insert(stack.end(), children[a].begin(), children[a].end());
  }
  return is_object;
}

/// Joins the axes into one tree, which begins with the axis at the points `root`. The base of this
/// axis is aligned with the root; other axes remain unchanged.
template <class ConcurrencyTag>
void join_axes(const Scan& scan,
               const std::vector<Index>& root,
               const std::optional<Vec3>& hint,
               const Ground& ground,
               const Branching_options& options,
               Axis_set& axes,
               Joined_axes& joined)
{
  joined.root = root_axis(scan, axes, root, hint);
  const bool is_reversed = is_root_reversed(scan, axes.axes[joined.root].axis, root);
  if (joined.aligned != joined.regroupings) // once, even if a cancelled call is repeated
    align_base_with_root(scan, root, joined.root, is_reversed, options.base, axes);
  joined.aligned = joined.regroupings;
  const Axis_joiner joiner(axes, scan.spacing, options.joints);
  joined.standing.clear();
  joined.joints = joiner.template run<ConcurrencyTag>(
      std::vector<Index>{joined.root},
      heights_above_ground(scan, axes, ground, options.joints.apart),
      ground.up,
      joined.standing);
  joined.joints[joined.root].is_reversed = is_reversed;
  joined.tree = branch_tree(axes, joined.joints, joined.root, scan.spacing);
}

/*!
  Joins the axes into a tree of branches, except for those that stand on the ground beside it. In
  several rounds, regroups and fuses the axes by the resulting branches. Splits unreachable axes,
  and prunes stubs. `progress(f)` gets the fraction of completed rounds. Returns `false` if it
  stopped the work.
*/
template <class ConcurrencyTag, class Progress>
bool build_branch_tree(const Scan& scan,
                       const std::vector<Index>& root,
                       const std::optional<Vec3>& hint,
                       const Ground& ground,
                       const Branching_options& options,
                       const Progress& progress,
                       Axis_set& axes,
                       Joined_axes& joined)
{
  const auto join = [&] {
    join_axes<ConcurrencyTag>(scan, root, hint, ground, options, axes, joined);
  };
  join();
  while (joined.regroupings + 1 < options.joints.rounds) {
    if (!progress(double(joined.regroupings + 1) / options.joints.rounds))
      return false;
    regroup_axes(joined.tree, axes);
    fuse_axes<ConcurrencyTag>(scan.spacing, options.fusion, axes);
    ++joined.regroupings;
    join();
  }
  const double reach = options.joints.reach * scan.spacing;
  std::vector<Index> roots = joined.standing;
  roots.push_back(joined.root);
  if (split_unreachable_axes(scan, reach, joined.joints, roots, axes) > 0)
    join();
  if (!progress(1))
    return false;
  prune_stubs(scan.spacing, options.stubs, joined.tree);
  return true;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_BUILD_BRANCH_TREE_H
