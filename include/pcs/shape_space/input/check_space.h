// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Checks that a space is built and that trees and modes belong to it.

#ifndef PCS_SHAPE_SPACE_INPUT_CHECK_SPACE_H
#define PCS_SHAPE_SPACE_INPUT_CHECK_SPACE_H

#include <pcs/core/errors.h>
#include <pcs/core/parameters/check_value.h>
#include <pcs/shape_space/model/Orl_coordinates.h>
#include <pcs/shape_space/model/Tree_family.h>

#include <cstddef>
#include <string>
#include <vector>

// All of these throw `pcs::Invalid_input` with a message that begins with `caller`, and allocate
// nothing otherwise.

namespace pcs {
namespace shape_space {

inline void check_built(const Tree_family& family, const char* caller)
{
  pcs::internal::check(!family.x.empty(), caller, "call build() first");
}

inline void check_handle(const Tree_family& family, std::size_t h, const char* caller)
{
  check_built(family, caller);
  if (h >= family.x.size())
    throw Invalid_input(std::string(caller) + ": there is no tree " + std::to_string(h));
}

/// Compares the numbers of edges and branches only: coordinates of another space with the same
/// numbers are accepted. `message`: "the tree is of another space", or the like.
inline void check_coordinates(const Tree_family& family,
                              const Orl_coordinates& x,
                              const char* caller,
                              const char* message)
{
  check_built(family, caller);
  pcs::internal::check(x.length.size() == family.layout.number_of_edges() &&
                           x.attachment.size() == family.layout.branches.size(),
                       caller,
                       message);
}

/// `scan_weights`: empty, or one per tree.
inline void check_tree(const Tree_family& family,
                       const Orl_coordinates& x,
                       const std::vector<double>& scan_weights,
                       const char* caller)
{
  const char* const message = "the tree is of another space";
  check_coordinates(family, x, caller, message);
  pcs::internal::check(scan_weights.empty() || scan_weights.size() == family.x.size(),
                       caller,
                       message);
}

} // namespace shape_space
} // namespace pcs

#endif // PCS_SHAPE_SPACE_INPUT_CHECK_SPACE_H
