// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Spaces of two trees without points.

#ifndef PCS_TEST_SUPPORT_ORL_SPACES_H
#define PCS_TEST_SUPPORT_ORL_SPACES_H

#include <pcs/Orl_shape_space.h>
#include <support/orl_trees.h>

namespace orl_test {

using Space = pcs::Orl_shape_space<Kernel>;

inline Space make_space(const Tree& a, const Tree& b)
{
  Space space;
  space.add_skeleton(a);
  space.add_skeleton(b);
  space.build();
  return space;
}

} // namespace orl_test

#endif // PCS_TEST_SUPPORT_ORL_SPACES_H
