// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Definitions of embed_tree.h.

#ifndef PCS_SHAPE_SPACE_FAMILY_EMBED_TREE_IMPL_H
#define PCS_SHAPE_SPACE_FAMILY_EMBED_TREE_IMPL_H

#include <pcs/shape_space/family/embed_tree.h>
#include <pcs/shape_space/family/make_family.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace pcs {
namespace shape_space {

template <class ConcurrencyTag>
Orl_coordinates embed_tree(const Tree_family& family, const Rooted_tree& tree, double* represented)
{
  std::vector<Shared_branch> branches(family.layout.branches.size());
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const Orl_layout::Branch& branch = family.layout.branches[b];
    branches[b].parent = branch.parent;
    branches[b].number_of_edges = branch.number_of_edges;
    branches[b].reference_edge =
        branch.parent == none
            ? 0
            : branch.reference_edge - family.layout.branches[branch.parent].first_edge;
  }
  Branch_paths paths;
  Shared_topology_builder<ConcurrencyTag> builder({&tree}, family.matching, 1);
  const double fraction =
      builder.project(tree, make_reference(family.layout, family.reference), branches, paths);
  if (represented)
    *represented = fraction;
  internal::Embedding x =
      internal::embed(family.layout, branches, tree, paths, 0, tree.origin - family.origin);
  if (family.orientation == Orl_orientation::world_axes)
    internal::set_world_frames(family.layout, x);
  else if (family.orientation == Orl_orientation::transported)
    internal::set_frames(family.layout, Quaternion::Identity(), x);
  else
    internal::turn_frames(family.layout,
                          internal::as_embedding(family.layout, family.reference),
                          Quaternion::Identity(),
                          x);
  internal::set_own_orientations(family.layout, family.orientation, x);
  Orl_coordinates reference = family.reference;
  if (family.orientation == Orl_orientation::world_axes) // the reference has orientations in frames
    internal::measure_as(Orl_orientation::world_axes, family.layout, reference);
  for (std::size_t b = 0; b < branches.size(); ++b)
    if (!branches[b].has(0)) {
      x.x.attachment[b] = reference.attachment[b];
      const std::size_t first = family.layout.branches[b].first_edge;
      for (std::size_t e = first; e < first + branches[b].number_of_edges; ++e)
        x.x.orientation[e] = reference.orientation[e];
    }
  return std::move(x.x);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_FAMILY_EMBED_TREE_IMPL_H
