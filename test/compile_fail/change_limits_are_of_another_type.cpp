// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The limits of changes must be of type Change_limits.

#include <pcs/compare_trees.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Change_limits;
#endif

void compile(const Space& space, const Option& value)
{
  pcs::find_branch_changes(space, 0, 1, pcs::parameters::change_limits(value));
}
