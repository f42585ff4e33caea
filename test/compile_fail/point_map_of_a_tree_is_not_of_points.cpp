// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A point has three coordinates.

#include <pcs/Orl_shape_space.h>

#include <vector>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = double;
#else
using Option = Space::Point_3;
#endif

void compile(const Space& space, const pcs::Orl_tree& tree, std::vector<Option>& result)
{
  space.points(tree, result);
}
