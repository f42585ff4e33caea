// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// What `Tree_skeletonization` does, without its point types, and without a look at how.

#ifndef PCS_SKELETON_SESSION_H
#define PCS_SKELETON_SESSION_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/progress.h>
#include <pcs/skeleton/input/Session_hints.h>
#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Branch_tree.h>
#include <pcs/skeleton/model/Joint.h>
#include <pcs/skeleton/model/Layer_tree.h>
#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcs {
namespace skeleton {

template <class ConcurrencyTag>
class Session_stages;

/// The stages in order; each runs those before it that have not run yet, and stops when cancelled.
template <class ConcurrencyTag>
class Session
{
public:
  /// `input` is finite, with at least two different points; `is_wood` is empty or has one entry per point.
  Session(std::vector<Vec3> input, std::vector<std::uint8_t> is_wood, Session_hints hints);
  ~Session();

  bool find_neighbors(pcs::internal::Progress& progress);
  bool find_paths(pcs::internal::Progress& progress);
  bool fit_axes(pcs::internal::Progress& progress);
  bool join(pcs::internal::Progress& progress);

  const Scan& scan() const;
  const Layer_tree& layers() const;
  const Axis_set& axes() const;
  const std::vector<Joint>& joints() const;
  const Branch_tree& tree() const;
  const Skeleton_report& report() const;

  /// The node that explains an input point, or `none`.
  Index node_of_input(std::size_t i) const;
  /// The unit vector across its branch from the axis to an input point; null on the axis. It has a node.
  Vec3 normal_of_input(std::size_t i) const;
  /// Distance of an input point from the surface of its branch; negative inside. It has a node.
  double residual_of_input(std::size_t i) const;
  /// Whether an input point is left out as a leaf, by the caller or because it was found to be one.
  bool is_leaf_of_input(std::size_t i) const;

private:
  std::unique_ptr<Session_stages<ConcurrencyTag>> m_stages;
};

} // namespace skeleton
} // namespace pcs

#ifndef PCS_COMPILED_SKELETON
#include <pcs/skeleton/Session_impl.h>
#endif

#endif // PCS_SKELETON_SESSION_H
