// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Topologies of trees, given by branches.

#ifndef PCS_TEST_SUPPORT_LAYOUTS_H
#define PCS_TEST_SUPPORT_LAYOUTS_H

#include <pcs/shape_space/model/Orl_coordinates.h>

#include <cstddef>
#include <vector>

namespace orl_test {

/// A branch of a topology; `reference_edge` is an edge of the parent, `none` for the trunk.
struct Layout_branch
{
  std::size_t parent, number_of_edges, reference_edge;
};

/// The topology of these branches, parents first.
inline pcs::shape_space::Orl_layout
layout_of(const std::vector<Layout_branch>& branches,
          pcs::Orl_orientation kind = pcs::Orl_orientation::gauge_fixed)
{
  pcs::shape_space::Orl_layout layout;
  for (const Layout_branch& b : branches) {
    const std::size_t first = layout.number_of_edges();
    layout.branches.push_back({b.parent, first, b.number_of_edges, b.reference_edge});
    for (std::size_t j = 0; j < b.number_of_edges; ++j)
      layout.edge_before.push_back(j == 0 ? b.reference_edge : first + j - 1);
  }
  set_parent_edges(layout, kind);
  return layout;
}

/// Coordinates of a tree of unit edges and radii 0.1 in the direction of z.
inline pcs::shape_space::Orl_coordinates upright_tree(const pcs::shape_space::Orl_layout& layout)
{
  pcs::shape_space::Orl_coordinates x;
  x.orientation.assign(layout.number_of_edges(), pcs::Quaternion::Identity());
  x.length.assign(layout.number_of_edges(), 1);
  x.radius.assign(layout.number_of_edges(), 0.1);
  x.base_radius.assign(layout.branches.size(), 0.1);
  x.attachment.assign(layout.branches.size(), 0);
  return x;
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_LAYOUTS_H
