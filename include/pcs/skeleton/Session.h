// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The stages of a skeletonization on plain coordinates: the compiled part of
// `Tree_skeletonization`.

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

struct Session_options;

template <class ConcurrencyTag>
struct Session_state;

/// The stages in order. Each stage first runs the preceding stages that are not completed. It
/// returns `false` if it is cancelled; the next call then continues the work.
template <class ConcurrencyTag>
class Session
{
public:
  /// `input` is finite, with at least two different points; `is_wood` is empty or has one entry per
  /// point.
  Session(std::vector<Vec3> input, std::vector<std::uint8_t> is_wood, Session_hints hints);
  /// Like the first constructor, but with the options of all stages.
  Session(std::vector<Vec3> input, std::vector<std::uint8_t> is_wood, Session_options options);
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
  /// Returns 1 for each point of the scan that may belong to the tree, otherwise 0.
  const std::vector<std::uint8_t>& used_points() const;

  /// Returns the node that explains an input point, or `none`.
  Index node_of_input(std::size_t i) const;
  /// Returns the unit vector from the axis to an input point that has a node; zero on the axis.
  Vec3 normal_of_input(std::size_t i) const;
  /// Returns the distance of an input point that has a node from the surface of its branch; it is
  /// negative inside [L].
  double residual_of_input(std::size_t i) const;
  /// Returns whether an input point is a leaf, by the caller or by the leaf-wood separation.
  bool is_leaf_of_input(std::size_t i) const;

  /// Releases the memory of the neighbours and of the search of the scan. No further stage can run.
  void release_neighbors();

  /// Returns the data of all stages, which Session_state.h defines.
  Session_state<ConcurrencyTag>& state() { return *m_state; }

private:
  std::unique_ptr<Session_state<ConcurrencyTag>> m_state;
};

} // namespace skeleton
} // namespace pcs

#ifndef PCS_COMPILED_SKELETON
#include <pcs/skeleton/Session_impl.h>
#endif

#endif // PCS_SKELETON_SESSION_H
