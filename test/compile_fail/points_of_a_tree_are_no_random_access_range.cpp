// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Points are written in parallel, so their range must be random access.

#include <pcs/Orl_shape_space.h>

#include <list>
#include <vector>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = std::list<Space::Point_3>;
#else
using Option = std::vector<Space::Point_3>;
#endif

void compile(const Space& space, const pcs::Orl_tree& tree, Option& result)
{
  space.points(tree, result);
}
