// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The options of random trees must be Tree_sampling_options.

#include <pcs/sample_tree.h>

using Space = pcs::Orl_shape_space<>;

#ifdef PCS_BREAK_THE_RULE
using Option = int;
#else
using Option = pcs::Tree_sampling_options;
#endif

void compile(const Space& space, const Option& value)
{
  pcs::sample_tree(space, 1, pcs::parameters::sampling_options(value));
}
