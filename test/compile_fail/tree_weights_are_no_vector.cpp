// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The tree weights must be a vector of numbers.

#include <pcs/mean_tree.h>

#include <vector>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = pcs::Tree_mean;
#else
using Option = std::vector<double>;
#endif

void compile(const Space& space, const Option& value)
{
  pcs::mean_tree(space, pcs::parameters::tree_weights(value));
}
