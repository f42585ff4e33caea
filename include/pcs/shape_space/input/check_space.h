// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks that a space is built and that trees and modes belong to it.

#ifndef PCS_SHAPE_SPACE_INPUT_CHECK_SPACE_H
#define PCS_SHAPE_SPACE_INPUT_CHECK_SPACE_H

#include <pcs/core/parameters/check_value.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Tree_family.h>

#include <cstddef>
#include <string>
#include <vector>

// All of these throw `pcs::Invalid_input` with a message that begins with `caller`.

namespace pcs {
namespace shape_space {

inline void check_built(const Tree_family& family, const std::string& caller)
{
  pcs::internal::check(!family.x.empty(), caller, "call build() first");
}

inline void check_handle(const Tree_family& family, std::size_t h, const std::string& caller)
{
  check_built(family, caller);
  pcs::internal::check(h < family.x.size(), caller, "there is no tree " + std::to_string(h));
}

/// `what`: "the tree is", "the modes are".
inline void check_coordinates(const Tree_family& family,
                              const Orl_coordinates& x,
                              const std::string& caller,
                              const std::string& what)
{
  check_built(family, caller);
  pcs::internal::check(x.length.size() == family.layout.number_of_edges() &&
                           x.attachment.size() == family.layout.branches.size(),
                       caller,
                       what + " of another space");
}

/// `scan_weights`: empty, or one per tree.
inline void check_tree(const Tree_family& family,
                       const Orl_coordinates& x,
                       const std::vector<double>& scan_weights,
                       const std::string& caller)
{
  check_coordinates(family, x, caller, "the tree is");
  pcs::internal::check(scan_weights.empty() || scan_weights.size() == family.x.size(),
                       caller,
                       "the tree is of another space");
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_CHECK_SPACE_H
