// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The option `tree_mean` is a value of an enumeration.

#include <pcs/mean_tree.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Tree_mean;
#endif

void compile(const Space& space, const Option& value)
{
  pcs::mean_tree(space, pcs::parameters::tree_mean(value));
}
