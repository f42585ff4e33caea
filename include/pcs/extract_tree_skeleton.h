// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The skeleton of a tree from a scan, in one call.

#ifndef PCS_EXTRACT_TREE_SKELETON_H
#define PCS_EXTRACT_TREE_SKELETON_H

#include <pcs/Tree_skeletonization.h>

namespace pcs {

/*!
  \ingroup PkgPcsSkeletonRef
  \brief finds the skeleton of a tree in a scan: nodes with radii, connected from the root to the
      tips.

  This is equivalent to one call of `extract()` of a `Tree_skeletonization`; see there for the
  model, the named parameters, errors, cost and determinism. The result is always one tree:
  connected, rooted, without cycles. Branches that cannot be connected are left out and counted in
  the report.

  | scan | result |
  |---|---|
  | fewer than `lowest_number_of_scan_points` distinct points, or a point that is not finite |
    `Invalid_input` |
  | a thin filled sheet (ground alone, a wall), unless `do_remove_ground(false)` |
    `Status::nothing_to_do`, `tree` unchanged |
  | a lamp post, a stick | the post is the trunk |
  | a bush | its thickest stem is the root; other stems within reach are branches of it |
  | two trees in one cloud | the tree with more points at its foot, relative to its height; the
    other is counted as unreached |
  | a body that is not a tree, such as a sphere | an arbitrary tree inside it |

  \tparam ConcurrencyTag `CGAL::Sequential_tag`, `CGAL::Parallel_tag` or
      `CGAL::Parallel_if_available_tag`
  \param points a model of `RandomAccessRange`
  \param tree a `Tree_skeleton`, or a mutable graph of Boost with `node_point_map` and
      `node_radius_map`; replaced
  \return a `Skeleton_report`: status, counts, sizes of the tree, seconds per stage
*/
template <class ConcurrencyTag = CGAL::Parallel_if_available_tag,
          class PointRange,
          class Graph,
          class NamedParameters = parameters::Default_named_parameters>
Skeleton_report extract_tree_skeleton(const PointRange& points,
                                      Graph& tree,
                                      const NamedParameters& np = NamedParameters())
{
  return Tree_skeletonization<PointRange, NamedParameters, ConcurrencyTag>(points, np)
      .extract(tree);
}

} // namespace pcs

#endif // PCS_EXTRACT_TREE_SKELETON_H
