// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Labels of the points of a scan: used, outlier, leaf, ground or wall.

#ifndef PCS_SKELETON_SCAN_POINT_LABELS_H
#define PCS_SKELETON_SCAN_POINT_LABELS_H

#include <pcs/core/Skeleton_report.h>
#include <pcs/internal/median.h>
#include <pcs/skeleton/model/Scan.h>
#include <pcs/skeleton/scan/prepare_scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcs {
namespace skeleton {

/// Labels of the points of a scan: tree, leaf, clutter or outlier. Points that do not belong to the
/// tree are kept in the scan for distances, and are marked as outliers there. The report counts
/// them.
template <class ConcurrencyTag>
class Point_labels
{
public:
  using Flags = std::vector<std::uint8_t>; ///< 1 or 0 for each point of the scan

  /// Keeps references to both, and updates them.
  Point_labels(Scan& scan, Skeleton_report& report) : m_scan(scan), m_report(report) {}

  /// Uses all points except outliers and leaves. `is_wood` has one entry per input point; if it is
  /// empty, all points may be wood. The scan must be prepared.
  void start(const Flags& is_wood)
  {
    const std::size_t n = m_scan.size();
    Flags may_be_wood(n, is_wood.empty());
    for (std::size_t i = 0; i < is_wood.size(); ++i)
      may_be_wood[m_scan.point_of_input[i]] |= is_wood[i];
    Flags is_used(n);
    for (std::size_t i = 0; i < n; ++i)
      is_used[i] = may_be_wood[i] && !m_scan.is_outlier[i];
    if (number_of(is_used) == 0)
      is_used = may_be_wood; // all points are outliers, and are used nevertheless
    use_only(is_used);
    m_is_leaf.resize(n);
    m_is_found_leaf.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i)
      m_is_leaf[i] = !may_be_wood[i];
    m_report.number_of_scan_points = n;
    m_report.merging_cell = m_scan.frame.unit * m_scan.cell_side;
    m_report.number_of_duplicates = m_report.number_of_points - n;
    m_report.number_of_leaf_points = number_of(m_is_leaf);
    m_report.number_of_outliers = number_of(m_scan.is_outlier) - m_report.number_of_leaf_points;
    m_report.spacing = m_scan.frame.unit * m_scan.spacing;
  }

  const Flags& flags() const { return m_is_used; }
  bool is_empty() const { return number_of(m_is_used) == 0; }
  /// Returns whether a point was removed as a leaf.
  bool is_leaf(Index i) const { return m_is_leaf[i] != 0; }

  /// Removes all points as ground.
  void remove_all()
  {
    m_report.number_of_ground_points = number_of(m_is_used);
    std::fill(m_is_used.begin(), m_is_used.end(), std::uint8_t(0));
  }

  /// Keeps only the points of `is_left`, and measures spacing and outliers again for these.
  void keep_only(Flags is_left)
  {
    measure_part<ConcurrencyTag>(is_left, m_scan);
    const std::size_t outliers = number_of(m_scan.is_outlier);
    if (outliers < number_of(is_left)) {
      for (std::size_t i = 0; i < m_scan.size(); ++i)
        is_left[i] = is_left[i] && !m_scan.is_outlier[i];
      m_report.number_of_outliers += outliers;
    }
    use_only(is_left);
    m_report.spacing = m_scan.frame.unit * m_scan.spacing;
  }

  /// Removes the used points for which `is_object(i)` holds. The spacing is not measured again.
  template <class IsObject>
  void remove_objects(const IsObject& is_object)
  {
    Flags is_left = m_is_used;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i] && is_object(i)) {
        is_left[i] = 0;
        ++m_report.number_of_object_points;
      }
    use_only(is_left);
  }

  /// Keeps only the points of `is_wood`; all other used points become leaves.
  void remove_leaves(const Flags& is_wood)
  {
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_used[i] && !is_wood[i]) {
        m_is_leaf[i] = m_is_found_leaf[i] = 1;
        ++m_report.number_of_leaf_points;
      }
    use_only(is_wood);
  }

  /// Leaves from leaf-wood separation, without those given by the caller. Points of cleared entries
  /// become wood by `restore_leaves()`.
  Flags& found_leaves() { return m_is_found_leaf; }

  /// Restores the `count` leaves for which `is_covered(i)` holds, and whose entries of
  /// `found_leaves()` are cleared, as used points.
  template <class IsCovered>
  void restore_leaves(std::size_t count, const IsCovered& is_covered)
  {
    m_report.number_of_leaf_points -= count;
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_leaf[i] && is_covered(i)) {
        m_is_leaf[i] = 0;
        m_is_used[i] = 1;
        m_scan.is_outlier[i] = 0;
      }
  }

  /// Restores all points that were removed by the leaf-wood separation.
  void undo_leaf_removal()
  {
    for (Index i = 0; i < m_scan.size(); ++i)
      if (m_is_found_leaf[i]) {
        m_is_leaf[i] = m_is_found_leaf[i] = 0;
        m_is_used[i] = 1;
        m_scan.is_outlier[i] = 0;
        --m_report.number_of_leaf_points;
      }
  }

  /// Returns the height of the highest leaves from leaf-wood separation, without the highest 1/1000
  /// of them, but at most ten, which may be stray points. The lowest number without leaves [L].
  double top_of_leaves(const Vec3& up) const
  {
    std::vector<double> heights;
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      if (m_is_found_leaf[i])
        heights.push_back(up.dot(m_scan.points[i]));
    if (heights.empty())
      return std::numeric_limits<double>::lowest();
    const std::size_t strays = std::min<std::size_t>(heights.size() / 1000, 10);
    return pcs::internal::value_of_rank(heights, heights.size() - 1 - strays);
  }

private:
  static std::size_t number_of(const Flags& flags)
  {
    return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
  }

  void use_only(const Flags& is_used)
  {
    m_is_used = is_used;
    for (std::size_t i = 0; i < m_scan.size(); ++i)
      m_scan.is_outlier[i] = !m_is_used[i];
  }

  Scan& m_scan;
  Skeleton_report& m_report;
  Flags m_is_used;
  Flags m_is_leaf, m_is_found_leaf; ///< the second: not labeled by the caller
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SCAN_POINT_LABELS_H
