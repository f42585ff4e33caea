// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removal of ground, walls and roofs: everything in a scan that is not a tree.

#ifndef PCS_SKELETON_CLUTTER_REMOVE_CLUTTER_H
#define PCS_SKELETON_CLUTTER_REMOVE_CLUTTER_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/parallel.h>
#include <pcs/skeleton/clutter/Wall_removal.h>
#include <pcs/skeleton/clutter/is_single_sheet.h>
#include <pcs/skeleton/clutter/mark_ground.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/layers/Stem_foot.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/Point_labels.h>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Options of `Clutter_removal`.
struct Clutter_options
{
  Ground_options ground;
  Wall_options walls;
};

/*!
  Removal of walls and roofs, then of the ground and all other flat faces. After a cancellation
  between these steps, the next call continues with the ground.
*/
template <class ConcurrencyTag>
class Clutter_removal
{
public:
  using Flags = std::vector<std::uint8_t>;

  /// Keeps references to its arguments.
  Clutter_removal(const Scan& scan,
                  const Clutter_options& options,
                  Point_labels<ConcurrencyTag>& labels,
                  Skeleton_report& report)
    : m_options(options),
      m_scan(scan),
      m_labels(labels),
      m_report(report),
      m_walls(scan, options.walls, labels, report)
  {
  }

  /// Removes walls and roofs. Returns `false` if the scan is a single sheet of ground; all points
  /// are then removed.
  bool remove_walls_and_roofs(const Vec3& up)
  {
    if (m_are_walls_removed)
      return true;
    if (is_single_sheet(m_scan, m_labels.flags(), m_options.ground.sheet)) {
      m_labels.remove_all();
      return false;
    }
    m_walls.leave_out_walls_and_roofs(up);
    m_are_walls_removed = true;
    return true;
  }

  /// Marks the ground among the points with `links`, and calls `meanwhile()` on another thread.
  /// `root`: of the tree, if it is given.
  template <class Meanwhile>
  void mark_ground(const Compact_links& links,
                   const Vec3& up,
                   const std::optional<Vec3>& root,
                   const Meanwhile& meanwhile)
  {
    m_is_above_ground = m_labels.flags();
    m_ground = Ground();
    pcs::internal::invoke_both<ConcurrencyTag>(
        [&] {
          m_ground =
              skeleton::mark_ground(m_scan, links, up, m_options.ground, root, m_is_above_ground);
        },
        meanwhile);
  }

  /// Removes the marked ground and all other flat faces. `find_links()` returns the links between
  /// the used points. Returns whether `links` changed.
  template <class FindLinks>
  bool remove_ground_and_faces(const FindLinks& find_links, Compact_links& links)
  {
    m_report.number_of_ground_points = m_ground.number_of_points;
    m_report.number_of_object_points = m_ground.number_of_object_points;
    const bool has_ground = m_ground.number_of_points + m_ground.number_of_object_points > 0;
    if (has_ground) {
      m_labels.keep_only(std::move(m_is_above_ground));
      links = find_links();
    }
    const bool may_have_faces = m_walls.has_faces() || has_ground; // otherwise, nothing has changed
    return (may_have_faces && m_walls.leave_out_rest(find_links, links)) || has_ground;
  }

  /// Returns the removed ground.
  const Ground& ground() const { return m_ground; }
  /// Returns the foot of the tree on the removed ground; no value without ground.
  std::optional<Stem_foot> foot() const { return m_ground.terrain ? m_ground.foot : std::nullopt; }

private:
  const Clutter_options& m_options;
  const Scan& m_scan;
  Point_labels<ConcurrencyTag>& m_labels;
  Skeleton_report& m_report;
  Wall_removal<ConcurrencyTag> m_walls;
  bool m_are_walls_removed = false;
  Flags m_is_above_ground;
  Ground m_ground;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_REMOVE_CLUTTER_H
