// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removal of walls, other flat faces, and objects beside them, in rounds.

#ifndef PCS_SKELETON_CLUTTER_WALL_REMOVAL_H
#define PCS_SKELETON_CLUTTER_WALL_REMOVAL_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/skeleton/clutter/mark_walls.h>
#include <pcs/skeleton/graph/Neighbor_graph.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/Point_labels.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcs {
namespace skeleton {

/// Removal of walls and roofs before the ground classification, and of other flat faces after it.
template <class ConcurrencyTag>
class Wall_removal
{
public:
  Wall_removal(const Scan& scan,
               const Wall_options& rules,
               Point_labels<ConcurrencyTag>& used,
               Skeleton_report& report)
    : m_scan(scan), m_rules(rules), m_used(used), m_report(report)
  {
  }

  /// Returns whether the last detection found any flat face.
  bool has_faces() const { return m_has_faces; }

  void leave_out_walls_and_roofs(const Vec3& up)
  {
    const std::vector<Flat_face> faces = find_faces();
    leave_out(walls_and_roofs(m_scan, faces, up, m_rules, m_used.flags()));
  }

  /// Removes the other faces and the remaining components beside them. `find_links` returns the
  /// links between the used points. Returns whether any points were removed.
  template <class FindLinks>
  bool leave_out_rest(const FindLinks& find_links, Compact_links& links)
  {
    bool is_found = false;
    for (int round = 1; round < m_rules.rounds && leave_out(find_faces()); ++round)
      is_found = true;
    if (is_found)
      links = find_links();
    std::vector<std::uint8_t> is_left = m_used.flags();
    const std::size_t marked = mark_beside_faces(m_scan, m_faces, links, m_rules, is_left);
    if (leave_out(marked, std::move(is_left))) {
      links = find_links();
      is_found = true;
    }
    return is_found;
  }

private:
  std::vector<Flat_face> find_faces()
  {
    std::vector<Flat_face> faces = flat_faces(m_scan, m_rules, m_used.flags());
    m_has_faces = !faces.empty();
    return faces;
  }

  bool leave_out(const std::vector<Flat_face>& faces)
  {
    std::vector<std::uint8_t> is_left = m_used.flags();
    const std::size_t marked = mark_faces(m_scan, faces, is_left);
    if (!leave_out(marked, std::move(is_left)))
      return false;
    m_faces.insert(m_faces.end(), faces.begin(), faces.end());
    return true;
  }

  /// Keeps only `is_left` if enough points remain. Returns whether points were removed.
  bool leave_out(std::size_t marked, std::vector<std::uint8_t> is_left)
  {
    const auto left = static_cast<std::size_t>(std::count(is_left.begin(), is_left.end(), 1));
    if (marked == 0 || double(left) < m_rules.least * double(left + marked))
      return false;
    m_report.number_of_wall_points += marked;
    m_used.keep_only(std::move(is_left));
    return true;
  }

  const Scan& m_scan;
  const Wall_options& m_rules;
  Point_labels<ConcurrencyTag>& m_used;
  Skeleton_report& m_report;
  std::vector<Flat_face> m_faces; ///< faces that were removed
  bool m_has_faces = false;
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_CLUTTER_WALL_REMOVAL_H
