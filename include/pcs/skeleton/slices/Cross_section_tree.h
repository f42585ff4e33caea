// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tree of cross-sections: removal of outliers and of redundant nodes.

#ifndef PCS_SKELETON_SLICES_CROSS_SECTION_TREE_H
#define PCS_SKELETON_SLICES_CROSS_SECTION_TREE_H

#include <pcs/skeleton/model/Scan.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcs {
namespace skeleton {

/// Largest ratio of the radius of a section to that of its parent [-].
constexpr double widest_section = 1.5;
/// Least distance of the nodes of a branch, in diameters [-].
constexpr double thinning_of_sections = 1;

/// Cross-sections of a tree or a forest. The steps of [Aiteanu 2022, section 3.7.5] remove some of
/// them; the first `number_of_fixed` are kept.
struct Cross_section_tree
{
  std::vector<Vec3> center;
  std::vector<double> radius;
  std::vector<Index> parent; ///< `none` at roots
  std::vector<Index> order;  ///< sections of the tree, parents before children
  std::vector<std::uint8_t> is_kept;
  std::size_t number_of_fixed = 0;

  /// Returns the number of kept children of each kept section.
  std::vector<std::size_t> count_children() const
  {
    std::vector<std::size_t> children(parent.size(), 0);
    for (const Index i : order)
      if (is_kept[i] && parent[i] != none)
        ++children[parent[i]];
    return children;
  }

  /// Removes sections that are much wider than their parents, and successively tips that lie within
  /// the radius of the parent as a whole: a center alone is inside wherever sections are dense. The
  /// parents of kept sections are then kept sections.
  void filter()
  {
    is_kept.assign(parent.size(), 0);
    for (const Index i : order) {
      is_kept[i] = 1;
      while (parent[i] != none && !is_kept[parent[i]])
        parent[i] = parent[parent[i]];
      if (parent[i] != none && i >= number_of_fixed &&
          radius[i] > widest_section * radius[parent[i]])
        is_kept[i] = 0;
    }
    std::vector<std::size_t> children = count_children();
    for (std::size_t k = order.size(); k-- > 0;) {
      const Index i = order[k], p = parent[i];
      if (!is_kept[i] || children[i] > 0 || p == none || i < number_of_fixed)
        continue;
      if ((center[i] - center[p]).norm() + radius[i] < radius[p]) {
        is_kept[i] = 0;
        --children[p];
      }
    }
  }

  /// Keeps roots, forks and tips, and other sections that are at least `thinning_of_sections`
  /// diameters from the last kept section towards the root. The parents of kept sections are then
  /// kept sections. Returns the kept section of each section: itself, or one towards the root.
  std::vector<Index> thin()
  {
    const std::vector<std::size_t> children = count_children();
    std::vector<Index> kept(parent.size(), none);
    for (const Index i : order) {
      const Index before = parent[i] == none ? none : kept[parent[i]];
      const bool is_needed =
          i < number_of_fixed || before == none || children[i] != 1 ||
          (center[i] - center[before]).norm() >= thinning_of_sections * 2 * radius[before];
      is_kept[i] = is_kept[i] && is_needed;
      kept[i] = is_kept[i] ? i : before;
      parent[i] = before;
    }
    return kept;
  }
};

} // namespace skeleton
} // namespace pcs

#endif // PCS_SKELETON_SLICES_CROSS_SECTION_TREE_H
