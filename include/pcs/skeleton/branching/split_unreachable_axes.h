// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Splitting of fused axes that cannot be reached from the root.

#ifndef PCS_SKELETON_BRANCHING_SPLIT_UNREACHABLE_AXES_H
#define PCS_SKELETON_BRANCHING_SPLIT_UNREACHABLE_AXES_H

#include <pcs/skeleton/model/Axis_set.h>
#include <pcs/skeleton/model/Joint.h>
#include <pcs/skeleton/model/Scan.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/*!
  Splits unreachable axes at the position where two pieces were fused at their bases. Two pieces
  with adjacent bases belong either to one branch that another branch crosses, or to two branches on
  opposite sides of a third branch. The second case is assumed if the fused axis is unreachable from
  the root, but a reachable axis lies within `reach` [L] of this position. Both pieces then become
  separate axes that begin there. `joints` are the joints of the axes, and `roots` are axes
  that need none. Returns the number of additional axes. O(axes log points + points).
*/
inline std::size_t split_unreachable_axes(const Scan& scan,
                                          double reach,
                                          const std::vector<Joint>& joints,
                                          const std::vector<Index>& roots,
                                          Axis_set& set)
{
  const std::size_t n = set.axes.size();
  std::vector<Index> other(n, none),
      meeting(n, 0); // new axis of the second piece, index of its first node
  std::vector<std::uint8_t> is_root(n, 0);
  for (const Index root : roots)
    is_root[root] = 1;
  const auto is_reached = [&](Index a) { return is_root[a] || joints[a].parent != none; };
  for (Index a = 0; a < n; ++a) {
    const std::size_t m = set.axes[a].meeting, size = set.axes[a].axis.size();
    if (is_reached(a) || m < 2 || m + 2 > size)
      continue;
    const auto near = scan.search->nearest_if(set.axes[a].axis[m].point, reach, [&](Index i) {
      const Index b = set.axis_of_point[i];
      return b != none && is_reached(b);
    });
    if (!(near.squared_distance < reach * reach))
      continue;
    Fitted_axis second = set.axes[a];
    Fitted_axis& first = set.axes[a];
    second.axis.erase(second.axis.begin(), second.axis.begin() + static_cast<std::ptrdiff_t>(m));
    first.axis.resize(m);
    std::reverse(first.axis.begin(), first.axis.end());
    first.meeting = second.meeting = 0;
    first.number_of_points = second.number_of_points = 0;
    first.direction = second.direction = 1;
    meeting[a] = static_cast<Index>(m);
    other[a] = static_cast<Index>(set.axes.size());
    set.axes.push_back(std::move(second));
  }
  for (std::size_t i = 0; i < set.axis_of_point.size(); ++i) {
    Index& a = set.axis_of_point[i];
    if (a == none || other[a] == none)
      continue;
    Index& s = set.segment_of_point[i];
    const Index m = meeting[a];
    const bool is_first = s + 1 < m; // the removed segment is left out
    s = is_first ? m - 2 - s : s - std::min(s, m);
    a = is_first ? a : other[a];
    ++set.axes[a].number_of_points;
  }
  return set.axes.size() - n;
}

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_BRANCHING_SPLIT_UNREACHABLE_AXES_H
