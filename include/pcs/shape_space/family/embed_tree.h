// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Embedding of further trees in the topology of a family.

#ifndef PCS_SHAPE_SPACE_FAMILY_EMBED_TREE_H
#define PCS_SHAPE_SPACE_FAMILY_EMBED_TREE_H

#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Rooted_tree.h>
#include <pcs/shape_space/model/Tree_family.h>

namespace pcs {
namespace shape_space {

/// Embeds a further tree in the topology of a family. `represented`, if not null: fraction of its
/// length on branches of the topology [-].
template <class ConcurrencyTag>
Orl_coordinates embed_tree(const Tree_family& family, const Rooted_tree& tree, double* represented);

} // namespace shape_space
} // namespace pcs

#ifndef PCS_COMPILED_SHAPE_SPACE
#include <pcs/shape_space/family/embed_tree_impl.h>
#endif

#endif // PCS_SHAPE_SPACE_FAMILY_EMBED_TREE_H
